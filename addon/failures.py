# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user is told of an exception. One that is Conic's own fault leaves a traceback as well, for a report."""

from .engine import ConicError


def is_defect(error):
    """Whether an exception is Conic's own fault, so that its traceback belongs in the console."""
    return not isinstance(error, (ConicError, MemoryError))


def sentence_of(error):
    """What a user is told of an exception."""
    if isinstance(error, MemoryError):
        return "not enough memory for this scene"
    return str(error) if not is_defect(error) else f"{type(error).__name__}: {str(error) or 'see the console'}"
