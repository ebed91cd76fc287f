# SPDX-License-Identifier: GPL-3.0-or-later
"""Which rays see an object, which objects a viewport shows, and what of them. As in Cycles."""

from ..engine.scene import Visibility

_ALL = int(Visibility.ALL)
_RAYS = tuple((f"visible_{ray.name.lower()}", int(ray)) for ray in Visibility.ALL)


class Visibilities:
    """The `Visibility` of copies in a view layer; `links`: the `LightLinks`."""

    def __init__(self, view_layer, links):
        self._view_layer, self._links = view_layer, links
        # Whether objects can be set apart by their collections: asking each object takes time.
        self._by_collections = any(
            layer.holdout or layer.indirect_only for layer in _and_children(view_layer.layer_collection)
        )
        self._made = {}

    def of(self, obj, root):
        """The `Visibility` of an evaluated object's copies that `root`, the object itself or its instancer, puts there.

        Rays see what both let them see; a holdout and what the camera sees only indirectly are so by the root, alone or
        by its collections; a shadow catcher is so by either.
        """
        bits, catches = seen_by(obj), obj.is_shadow_catcher
        if root != obj:
            bits &= seen_by(root)
            catches = catches or root.is_shadow_catcher
        holdout = root.is_holdout
        if self._by_collections:
            original = root.original
            holdout = holdout or original.holdout_get(view_layer=self._view_layer)
            if not holdout and original.indirect_only_get(view_layer=self._view_layer):
                bits &= ~int(Visibility.CAMERA)
        if bits:
            bits |= (Visibility.HOLDOUT if holdout else 0) | (Visibility.SHADOW_CATCHER if catches else 0)
            bits |= self._links.groups_of(obj, root)
        if bits not in self._made:
            self._made[bits] = Visibility(bits)
        return self._made[bits]


def layer_flags(view_layer):
    """What the collections of a view layer say of how their objects are seen."""
    return tuple((layer.holdout, layer.indirect_only) for layer in _and_children(view_layer.layer_collection))


def _and_children(layer):
    yield layer
    for child in layer.children:
        yield from _and_children(child)


def seen_by(obj):
    """The rays, bits, that an object's own flags let see it."""
    bits = _ALL
    for flag, ray in _RAYS:
        if not getattr(obj, flag):
            bits &= ~ray
    return bits


def shown_in(space):
    """The question whether a viewport, a SpaceView3D, shows an evaluated object of the scene: local view, hidden
    collections and types of object. `space` None: a render, which shows all. A local view keeps the scene's lights:
    in the dark there would be nothing to see of what one wants to look at."""
    if space is None:
        return lambda obj: True
    is_local = space.local_view is not None
    return lambda obj: (is_local and obj.type == "LIGHT") or obj.visible_in_viewport_get(space)


def shows_hair(obj):
    """Whether an evaluated object has particle systems that show hair as strands; it does so also where it does not
    show itself."""
    return any(
        system.settings.type == "HAIR" and system.settings.render_type == "PATH" for system in obj.particle_systems
    )
