# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of an object: as which shape to render it, how thick its lines are, what it was taken as, and why."""

import textwrap

import bpy

from ..properties import PRIMITIVES
from ..sync.description import describe
from .base import PropertiesPanel, as_rows
from .object_visibility import is_seen

#: Types of objects whose faces can stand for a shape.
SHAPED = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

NAMES = {identifier: name for identifier, name, _ in PRIMITIVES} | {"NONE": "Nothing", "UNKNOWN": "Not known"}

#: What objects were taken as, by session_uid, until anything changes: a panel is drawn far more often.
_described = {}


@bpy.app.handlers.persistent
def _forget(*_arguments):
    _described.clear()


def described(obj, depsgraph):
    """(kind, reason) of an object, read from its mesh at most once after each change."""
    if obj.session_uid not in _described:
        _described[obj.session_uid] = describe(obj, depsgraph)
    return _described[obj.session_uid]


def may_have_lines(obj, depsgraph):
    """Whether an object may show curves or edges that have no thickness of their own."""
    if obj.type != "MESH":
        return obj.type == "CURVE"
    makes_curves = any(modifier.type == "NODES" for modifier in obj.modifiers)
    return makes_curves or obj.conic.strand_radius > 0.0 or not obj.evaluated_get(depsgraph).data.polygons


class CONIC_OBJECT_PT_shape(PropertiesPanel, bpy.types.Panel):
    bl_label = "Conic"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return is_seen(context.object) and super().poll(context)

    def draw(self, context):
        layout, obj, depsgraph = as_rows(self.layout), context.object, context.evaluated_depsgraph_get()
        if obj.type in SHAPED:
            layout.prop(obj.conic, "primitive")
        if may_have_lines(obj, depsgraph):
            layout.prop(obj.conic, "strand_radius")
        kind, reason = described(obj, depsgraph)
        column = layout.column(align=True)
        column.label(text=f"Rendered as: {NAMES.get(kind) or kind.replace('_', ' ').capitalize()}", icon="INFO")
        column.active = False
        for line in textwrap.wrap(reason, max(24, context.region.width // 9)):
            column.label(text=line)


_HANDLERS = ("depsgraph_update_post", "frame_change_post", "load_post", "undo_post", "redo_post")
_register_classes, _unregister_classes = bpy.utils.register_classes_factory((CONIC_OBJECT_PT_shape,))


def register():
    _register_classes()
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).append(_forget)


def unregister():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(_forget)
    _unregister_classes()
    _forget()
