"""What is not rendered gets named, and what is not Conic's business does not."""

import bpy
import pytest

from tests.blender.building import GeometryNodes, add_camera, link, sync, with_nodes


@pytest.fixture(autouse=True)
def lit_scene():
    add_camera()
    link(bpy.data.lights.new("lamp", "SUN"), "lamp")


def test_grease_pencil_is_blenders_own():
    add = getattr(bpy.ops.object, "grease_pencil_add", None) or bpy.ops.object.gpencil_add
    add(type="MONKEY")
    assert not sync().warnings()


@pytest.mark.skipif(hasattr(bpy.types.Object, "evaluated_geometry"), reason="can be read")
def test_curves_made_by_nodes_are_named_where_they_cannot_be_read():
    nodes = GeometryNodes()
    nodes.output(nodes.add("CurvePrimitiveCircle"))
    with_nodes(nodes).conic.strand_radius = 0.1
    assert sync().warnings("'host'", "curves", "Blender 4.5")
