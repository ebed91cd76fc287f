# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits of a scene, of the window and of the settings, as a user makes them; all of it follows from a seed.

Each edit is a function of an `Edits` that is registered with a weight. It returns what it did, for the log; one that
needs the application's main loop in between is a generator that yields to wait and returns the text at its end.
"""

import random

import bpy
from mathutils import Vector

from tests.app.live_view import view_parts

WEIGHTS = {}  # of each edit


def edit(weight):
    """Register a function as an edit that comes up in proportion to `weight`."""

    def register(function):
        WEIGHTS[function] = weight
        return function

    return register


class Edits:
    """Makes random choices, and makes the next edit."""

    def __init__(self, seed, folder):
        self.random, self.folder, self.count = random.Random(seed), folder, 0

    def choose(self):
        """The next edit."""
        self.count += 1
        return self.random.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]

    # Choices: of names in order, so that they do not depend on addresses

    def one(self, things):
        """One of some things with names; None of none."""
        things = sorted(things, key=lambda thing: thing.name)
        return self.random.choice(things) if things else None

    def object(self, *kinds):
        """An object of the scene, of these types if any are given."""
        return self.one(obj for obj in bpy.context.scene.objects if not kinds or obj.type in kinds)

    def number(self, low, high):
        return self.random.uniform(low, high)

    def vector(self, size):
        return Vector([self.number(-size, size) for _ in range(3)])

    def color(self):
        return *(self.random.random() for _ in range(3)), 1.0

    def name(self, kind):
        return f"{kind} {self.count}"


def operate(operator, *arguments, **options):
    """Call an operator in the 3D viewport; whether it could be called."""
    with bpy.context.temp_override(**view_parts()):
        if not operator.poll():
            return False
        operator(*arguments, **options)
    return True


def link(obj):
    bpy.context.scene.collection.objects.link(obj)
    return obj


def spaces():
    """Those of all 3D viewports of the window."""
    screen = bpy.context.window_manager.windows[0].screen
    return [area.spaces.active for area in screen.areas if area.type == "VIEW_3D"]
