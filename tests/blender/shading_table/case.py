"""What a line of the table is made of."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field
from itertools import product
from math import inf

import bpy

#: Names of sockets that Blender has changed, either way.
_OTHER_NAMES = {"Fac": "Factor", "Factor": "Fac", "Distance": "Filter Width"}
#: Of a version that never comes.
_NEVER = (99,)


@dataclass(frozen=True)
class Case:
    """A line of the table. `tolerance`: of the median relative error. `few`: the share of pixels that may differ by
    more than 10%, as at edges. `constant`: whether the same is seen everywhere; `black`: and is 0. `told`: what
    Conic's warnings must say; without it none is allowed."""

    name: str
    _: KW_ONLY
    tolerance: float = 0.02
    few: float = 0.05
    since: tuple = ()
    until: tuple = _NEVER
    reason: str = ""
    constant: bool = False
    black: bool = False
    told: str = ""

    def __post_init__(self):
        excepted = self.tolerance > 0.02 or self.few > 0.2 or getattr(self, "total", 0.0) > 0.03
        assert bool(self.reason) == excepted, f"{self.name}: exceptions have a reason"


@dataclass(frozen=True)
class Swatch(Case):
    """What a node gives, as emission of an object in a square of a picture that many share.

    `shown`: a Node; or a function of (tree, socket) that feeds the socket. `on`: the name of a shape of `shapes`.
    `of_object`: what is set of the object. `scale`: of what is shown: nothing may be below -1 of it.
    """

    shown: "Node | Callable" = None
    on: str = "plate"
    of_object: dict = field(default_factory=dict)
    scale: float = 0.005


@dataclass(frozen=True)
class Scene(Case):
    """A picture of its own: `build` adds objects, camera, lights and world to an empty scene.

    `blocks`: where both are noisy, means of squares of so many pixels are compared. `total`: how much more or less
    light all of the picture may have. `brightest`: what is brighter counts as this.
    """

    build: Callable = None
    samples: int = 64
    size: tuple = (48, 36)
    blocks: int = 1
    total: float = 0.02
    brightest: float = inf


class Node:
    """A shader node and what feeds it.

    `kind`: its type without "ShaderNode". `output`: name, identifier or number; the first where there is none. `feed`:
    values of its enabled inputs in their order. `then`: called with the node at last.
    """

    def __init__(self, kind, output=0, *, feed=(), then=None, **values):
        self.kind, self.output, self.feed, self.then, self.values = kind, output, feed, then, values

    def build(self, tree):
        """The output socket of the new node in a tree."""
        node = tree.nodes.new(self.kind if "Node" in self.kind else f"ShaderNode{self.kind}")
        for name, value in self.values.items():
            if name[0].islower():
                setattr(node, name, value)
        for name, value in self.values.items():
            if not name[0].islower():
                _set(tree, _find(node.inputs, name), value)
        for socket, value in zip([s for s in node.inputs if s.enabled], self.feed, strict=False):
            _set(tree, socket, value)
        if self.then:
            self.then(node)
        return _find(node.outputs, self.output)


def every(name, kind, output=0, *, case=None, **values):
    """A Swatch of a node for each combination of its settings that are lists, called by `name` and by what is chosen.
    `case`: settings of all the cases."""
    values |= {"output": output}
    lists = {key: value for key, value in values.items() if isinstance(value, list)}
    for chosen in product(*lists.values()):
        names = (getattr(choice, "__name__", str(choice)) for choice in chosen)
        node = Node(kind, **values | dict(zip(lists, chosen, strict=True)))
        yield Swatch(" ".join((name, *names)), node, **case or {})


def _find(sockets, name):
    """A socket by number among the enabled ones, by name or by identifier."""
    enabled = [socket for socket in sockets if socket.enabled]
    if isinstance(name, int):
        return enabled[name]
    names = (name, name.replace("_", " "))
    names += tuple(_OTHER_NAMES[n] for n in names if n in _OTHER_NAMES)
    found = [s for s in enabled for n in names if n in (s.name, s.identifier)]
    assert found, f"{sockets[0].node.bl_idname} has no socket {name!r}, only {[s.name for s in enabled]}"
    return found[0]


def _set(tree, socket, value):
    if isinstance(value, Node):
        tree.links.new(value.build(tree), socket)
    elif value is not None:
        socket.default_value = value


def choices(kind, setting):
    """What a setting of a node can be in this Blender."""
    return list(getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[setting].enum_items.keys())


#: Attributes of the plate: of each face colors of any sign, small, whole and zero, and numbers; of each point a place
#: in space.
A, B, C, D = COLORS = tuple(Node("Attribute", "Vector", attribute_name=name) for name in "abcd")
K, L, M, N = NUMBERS = tuple(Node("Attribute", "Alpha", attribute_name=name) for name in "abcd")
PLACE = Node("Attribute", "Vector", attribute_name="place")
