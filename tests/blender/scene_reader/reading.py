"""A reader that reads again beside one that reads for the first time."""

from types import SimpleNamespace

import bpy
import numpy as np

from addon.engine.expression import Call, Expression, Parameter
from addon.fingerprint import fingerprint
from addon.sync.scene_reader import SceneReader


class Reading:
    """A SceneReader that hears of Blender's changes, as a viewport does."""

    def __init__(self, space=None):
        self.messages, self.space = [], space
        self.reader = SceneReader(lambda *message: self.messages.append(message))
        self.handler = lambda _scene, depsgraph: self.reader.mark(depsgraph)
        bpy.app.handlers.depsgraph_update_post.append(self.handler)
        bpy.app.handlers.frame_change_post.append(self.handler)
        self.scene = None

    def read(self):
        """The Scene; it must be what a reader sees that reads for the first time."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.messages.clear()
        self.scene = self.reader.read(depsgraph, 64, 48, space=self.space)
        messages = []
        fresh = SceneReader(lambda *message: messages.append(message)).read(depsgraph, 64, 48, space=self.space)
        assert sorted(self.messages) == sorted(messages)
        assert list(differences(plain(self.scene), plain(fresh))) == []
        return self.scene

    def renewed(self, edit):
        """What an edit renews of the Scene, as `things` names it."""
        before = things(self.scene or self.read())
        edit()
        after = things(self.read())
        return {name for name, thing in after.items() if before.get(name) is not thing} | {
            f"-{name}" for name in before.keys() - after.keys()
        }

    def numbered(self, names):
        """Names of things, those of materials by their numbers as `things` has them."""
        return {f"material {self._number(name[9:])}" if name.startswith("material ") else name for name in names}

    def _number(self, name):
        key = "material", bpy.data.materials[name].session_uid
        return self.reader._materials.of(key)[0]


def things(scene):
    """What keeps its identity, by name."""
    found = {"shapes": scene.shapes}
    for placed in scene.instances:
        found[f"placed {placed.name}"] = placed
        found[f"geometry {placed.name}"] = placed.geometry
    found |= {f"material {number}": made for number, made in enumerate(scene.materials)}
    return found | {f"image {number}": made for number, made in enumerate(scene.images)}


def plain(scene):
    """The content of a Scene, whatever the numbers of its materials and images, by part."""
    digests = [_digest(made, scene) for made in scene.materials]
    return {
        "camera": scene.camera,
        "lights": scene.lights,
        "world": _resolved(scene.world, scene),
        "shapes": _rows(scene.shapes, digests),
        "planes": [_columns(planes, digests) for planes in scene.planes],
        "instances": [
            (
                placed.name,
                np.array(placed.matrices),
                None if placed.materials is None else [digests[number] for number in placed.materials],
                int(placed.visibility),
                {key: np.array(values) for key, values in sorted(placed.attributes.items())},
                _rows(placed.geometry, digests if placed.materials is None else None),
            )
            for placed in scene.instances
        ],
    }


def differences(found, expected, path=""):
    """Yield the paths to where plain contents differ."""
    if type(found) is not type(expected):
        yield f"{path}: {type(found).__name__} {type(expected).__name__}"
    elif isinstance(expected, dict) and found.keys() == expected.keys():
        for key in expected:
            yield from differences(found[key], expected[key], f"{path}.{key}")
    elif isinstance(expected, list | tuple) and len(found) == len(expected):
        for i, (a, b) in enumerate(zip(found, expected, strict=True)):
            yield from differences(a, b, f"{path}[{i}]")
    elif fingerprint(found) != fingerprint(expected):
        yield f"{path}: {found} {expected}"


def _rows(geometry, digests):
    return [geometry.name, *((label, _columns(part, digests)) for label, part in geometry.kinds())]


def _columns(part, digests):
    """All arrays of primitives in full; their materials are those `digests`, or slots."""
    columns = {column.name: np.array(getattr(part, column.name)) for column in part.columns}
    if digests is not None:
        columns["material"] = np.array([digests[number] for number in part.material])
    return columns | {f"attribute {key}": np.array(values) for key, values in sorted(part.attributes.items())}


def _digest(made, scene):
    return int.from_bytes(fingerprint(_resolved(made, scene))[:7], "little")


def _resolved(owner, scene):
    """A Material or World, its expressions with images in place of their numbers."""
    seen = {}
    return {name: _resolve(value, scene, seen) for name, value in vars(owner).items()}


def _resolve(value, scene, seen):
    if not isinstance(value, Expression):
        return value
    if id(value) not in seen:
        inputs = list(getattr(value, "inputs", ()))
        made = SimpleNamespace(kind=type(value).__name__, **{**vars(value), "inputs": ()})
        seen[id(value)] = made
        if isinstance(value, Call) and value.name.startswith("image_sample"):
            count = int(inputs[1].value[0]) if value.name.endswith("tiled") else 1
            first = int(inputs.pop(0).value[0])
            assert isinstance(value.inputs[0], Parameter)
            made.images = [vars(scene.images[first + i]) for i in range(count)]
        made.inputs = [_resolve(other, scene, seen) for other in inputs]
    return seen[id(value)]
