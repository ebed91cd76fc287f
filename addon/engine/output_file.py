# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are either written whole or not at all."""

import os
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import ConicError


@contextmanager
def written_whole(path):
    """Yield the path of a temporary file beside `path` that becomes `path` when the block ends well, and else
    vanishes.

    Raises ConicError where the system refuses.
    """
    # A link stays a link: what it points to is what is written.
    target = Path(os.path.realpath(path))
    # Pillow and OpenEXR go by the suffix, so it stays the last.
    temporary = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        raise ConicError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            temporary.unlink()


def check_writable(path):
    """Raise ConicError where `written_whole(path)` would fail for a reason that is known beforehand."""
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise ConicError(f"{path}: is a folder, expected the name of a file")
    if not target.parent.is_dir():
        raise ConicError(f"{path}: the folder {target.parent} does not exist")
    if not os.access(target.parent, os.W_OK | os.X_OK) or (target.exists() and not os.access(target, os.W_OK)):
        raise ConicError(f"{path}: cannot be written: permission denied")
