# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender says has changed, as the tokens of `memory`: uids, which live on where references die."""

import bpy

from .keys import original_key

#: Something that makes or moves objects has changed: what only Blender's iterator knows depends on all of it.
OBJECTS = "objects"


def geometry_of(uid):
    """The token of the geometry of an object or of data."""
    return "geometry", uid


#: Of these Blender tags whoever uses them too.
_FLUSHED = tuple(
    getattr(bpy.types, name)
    for name in (
        *("Mesh", "Curve", "MetaBall", "Curves", "PointCloud", "Volume", "Lattice", "Armature", "Key", "Light"),
        *("Camera", "LightProbe", "Speaker", "Material", "World", "Image", "NodeTree", "Action", "MovieClip", "Sound"),
        *("GreasePencil", "GreasePencilv3", "Text", "VectorFont"),
    )
    if hasattr(bpy.types, name)
)
_OF_OBJECTS = (bpy.types.Object, bpy.types.Collection, bpy.types.ParticleSettings, bpy.types.Scene)


class Changes:
    """Collects what Blender reports until it is taken. `everything`: nothing that was read holds any more."""

    def __init__(self):
        self.tokens, self.everything = set(), False

    def mark(self, updates):
        """Note `depsgraph.updates`. Without any Blender says that something has changed, not what."""
        if not len(updates):
            self.tokens.add(OBJECTS)
        for update in updates:
            self._mark(update)

    def _mark(self, update):
        owner = update.id.original
        uid = owner.session_uid
        self.tokens.add(uid)
        if update.is_updated_geometry:
            self.tokens.add(geometry_of(uid))
        if isinstance(owner, _OF_OBJECTS):
            self.tokens.add(OBJECTS)
        elif not isinstance(owner, _FLUSHED):
            self.everything = True
        elif isinstance(owner, bpy.types.Material) and not (
            update.is_updated_shading or update.is_updated_transform or update.is_updated_geometry
        ):  # as when its images are loaded anew
            self.tokens.update(ids_in(owner.node_tree))


def ids_in(tree):
    """The uids of all that the nodes of a tree use: images, objects, groups and what is in them."""
    found, trees = set(), [tree]
    while trees:
        tree = trees.pop()
        for node in tree.nodes if tree is not None else ():
            for name in ("image", "object", "node_tree"):
                used = getattr(node, name, None)
                if used is not None and original_key(used) not in found:
                    found.add(original_key(used))
                    trees += [used] if name == "node_tree" else []
    return found
