"""Print the pins of dependency groups of pyproject.toml, a line each: python tools/pins.py GROUP..."""

import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

GROUPS = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())["dependency-groups"]


def expand(group: str) -> Iterator[str]:
    """The pins of a group, those of the groups that it includes among them."""
    for pin in GROUPS[group]:
        if isinstance(pin, str):
            yield pin
        else:
            yield from expand(pin["include-group"])


print(*(pin for group in sys.argv[1:] for pin in expand(group)), sep="\n")
