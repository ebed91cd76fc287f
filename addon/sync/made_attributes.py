# SPDX-License-Identifier: GPL-3.0-or-later
"""The attributes that materials make from others, for a scene in which all objects stand.

An expression is evaluated on the primitives of a geometry where these have one of its attributes, else on the
instances: as the engine looks an attribute up.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .attributes import of_primitives
from .expressions import evaluate

#: An alpha that is less than 1 by more can be seen.
_OPAQUE = 1e-3


def attributes_of(material):
    """The keys of the attributes of an engine Material."""
    return {getattr(material, f"{color}_attribute") for color in ("diffuse", "reflect", "transmit", "glow")} - {""}


def make_attributes(scene, made, opacities, reports):
    """Give an engine scene's primitives and instances the attributes that its materials name, and no others.

    `made`: expressions by key. `opacities`: (expression, name, material numbers) of what was taken as 1: what is not is
    reported, with the name of the Blender material.
    """
    named = [attributes_of(material) for material in scene.materials]
    for key, expression in made.items():
        users = np.array([key in keys for keys in named])
        if users.any():
            _Walk(scene, expression, users, reports, _Keep(key)).run()
    for expression, name, numbers in opacities:
        users = np.isin(np.arange(len(named)), numbers)
        _Walk(scene, expression, users, reports, _Check(name, reports)).run()
    if made or opacities:
        _drop_others(scene, set().union(*named))


@dataclass(frozen=True)
class _Keep:
    """Makes values an attribute of primitives or instances."""

    key: str

    def __call__(self, owner, values, rows):
        object.__setattr__(owner, "attributes", owner.attributes | {self.key: values})


@dataclass(frozen=True)
class _Check:
    """Reports values that should be 1."""

    name: str
    reports: object

    def __call__(self, owner, values, rows):
        alpha = values[:1] if values.strides[0] == 0 else values[rows]
        if alpha[..., 0].min(initial=1.0) < 1.0 - _OPAQUE:
            self.reports.warn(f"material {self.name!r}: its alpha varies with an attribute; it is drawn opaque")


@dataclass(frozen=True)
class _Walk:
    """Evaluates an expression wherever materials, `users` (m,) bool, need it: `take(owner, values, rows)`, with what
    has attributes, their values for all of its rows, and which of these are needed, (n,) bool."""

    scene: object
    expression: object
    users: np.ndarray
    reports: object
    take: Callable

    def run(self):
        for part in (*(part for _, part in self.scene.shapes.kinds()), *self.scene.planes):
            rows = self.users[part.material]
            if rows.any():
                self._of_part(part, part.attributes, rows)
        placed_of = {}
        users = set(np.flatnonzero(self.users).tolist())
        for placed in self.scene.instances:
            if placed.materials is None or not users.isdisjoint(placed.materials):
                placed_of.setdefault(id(placed.geometry), []).append(placed)
        for placed in placed_of.values():
            self._of_geometry(placed)

    def _of_geometry(self, placed):
        """Of a geometry and all that is `placed` of it with these materials."""
        of_instances = {}
        count = max(len(self.users), *(len(p.materials or ()) for p in placed))
        slots = np.array([self._slots(p, count) for p in placed])
        for _, part in placed[0].geometry.kinds():
            is_used = np.zeros(slots.shape[1], bool)
            is_used[part.material] = True
            needed = [p for p, needs in zip(placed, (slots & is_used).any(axis=1), strict=True) if needs]
            if needed and not part.attributes.keys().isdisjoint(of_primitives(self.expression.keys)):
                self._of_part(part, part.attributes | self._even(needed), slots.any(axis=0)[part.material])
            else:
                of_instances |= {id(p): p for p in needed}
        for p in of_instances.values():
            self.take(p, evaluate(self.expression, p.attributes, (len(p),)), np.ones(len(p), bool))

    def _of_part(self, part, values, rows):
        places = max((values[key].shape[1] for key in self.expression.keys if key in values), default=1)
        self.take(part, evaluate(self.expression, values, (len(part), places)), rows)

    def _slots(self, placed, count):
        """Which slots (count,) of Instances have a material that needs it."""
        found = self.users if placed.materials is None else self.users[list(placed.materials)]
        return np.pad(found, (0, count - len(found)))

    def _even(self, placed):
        """Attributes of Instances that are the same on all of them, (1, 1, 4) by key; what is not is reported."""
        even = {}
        for key in self.expression.keys & set().union(*(p.attributes for p in placed)):
            values = [p.attributes.get(key, np.zeros((1, 4), np.float32)) for p in placed]
            first = values[0][:1]
            if all((each == first).all() for each in values):
                even[key] = first[None]
            else:
                self.reports.warn(
                    f"object {placed[0].name!r}: a material combines attributes of its geometry and of its instances; "
                    "those of the instances are not rendered"
                )
        return even


def _drop_others(scene, named):
    """Remove the attributes that nothing names: what others were made from."""
    parts = {id(part): part for placed in scene.instances for _, part in placed.geometry.kinds()}
    for owner in (*(part for _, part in scene.shapes.kinds()), *scene.planes, *parts.values(), *scene.instances):
        kept = {key: values for key, values in owner.attributes.items() if key in named}
        object.__setattr__(owner, "attributes", kept)
