"""Recognition of what Blender itself adds: every primitive, its options, its uv maps, and edits made with Blender."""

import math

import bpy
import numpy as np
import pytest

from addon.sync.recognise import MeshArrays, recognise
from tests.exact_shapes import assert_exact


def arrays(mesh) -> MeshArrays:
    """The arrays of a bpy mesh."""

    def read(collection, name, count, dtype):
        values = np.empty(count, dtype)
        collection.foreach_get(name, values)
        return values

    v, f, c = len(mesh.vertices), len(mesh.polygons), len(mesh.loops)
    starts = read(mesh.polygons, "loop_start", f, np.int32)
    return MeshArrays(
        read(mesh.vertices, "co", 3 * v, np.float32).reshape(-1, 3),
        read(mesh.loops, "vertex_index", c, np.int32),
        np.append(starts, c).astype(np.int32),
        read(mesh.polygons, "use_smooth", f, bool),
        read(mesh.polygons, "material_index", f, np.int32),
        read(mesh.uv_layers.active.uv, "vector", 2 * c, np.float32).reshape(-1, 2) if mesh.uv_layers else None,
    )


def active() -> MeshArrays:
    """The arrays of the active object's mesh."""
    return arrays(bpy.context.object.data)


FILLS = ("NGON", "TRIFAN", "NOTHING")
CASES = [("uv_sphere", {"segments": n, "ring_count": r}) for n, r in ((32, 16), (12, 6), (13, 7), (50, 21), (96, 48))]
CASES += [("ico_sphere", {"subdivisions": s}) for s in (2, 3, 4, 6)]
for fill in FILLS:
    for n in (12, 13, 32, 33, 100, 500):
        CASES.append(("cylinder", {"vertices": n, "end_fill_type": fill, "depth": 0.1 * n}))
        for radii in ((1, 0), (0, 0.5), (1, 0.5), (0.5, 1), (1, 0.999)):
            CASES.append(
                (
                    "cone",
                    {
                        "vertices": n,
                        "end_fill_type": fill,
                        "radius1": radii[0],
                        "radius2": radii[1],
                        "depth": 3,
                    },
                )
            )
        if fill != "NOTHING":
            CASES.append(("circle", {"vertices": n, "fill_type": fill}))
KINDS = {
    "uv_sphere": "SPHERE",
    "ico_sphere": "SPHERE",
    "cylinder": "CYLINDER",
    "cone": "CONE",
    "circle": "DISC",
}


def add(name, **options):
    """Add one of Blender's meshes and return its object."""
    getattr(bpy.ops.mesh, f"primitive_{name}_add")(**options)
    return bpy.context.object


def test_every_added_mesh_and_its_uv_map_is_found():
    for name, options in CASES:
        add(name, **options)
        mesh = active()
        found = recognise(mesh)
        assert found.kind == KINDS[name], (name, options, found.reason)
        assert found.local is None and not found.all_smooth
        assert found.uv_matches == (name != "ico_sphere"), (name, options)
        assert_exact(mesh, found, uv=name != "ico_sphere")
        bpy.data.objects.remove(bpy.context.object)


def test_every_added_mesh_is_found_when_its_transform_is_applied():
    settings = {"location": (0.3, -2, 0.5), "rotation": (0.3, 1.1, -2.0)}
    for name, options in CASES[::3]:
        for scale in ((0.01, 0.01, 0.01), (400, 400, 400), (1, 2, 0.5)):
            shape = add(name, **options, **settings)
            shape.scale = scale
            bpy.ops.object.transform_apply()
            mesh = active()
            found = recognise(mesh)
            assert found.kind == KINDS[name], (name, options, scale, found.reason)
            assert_exact(mesh, found, uv=name != "ico_sphere")
            bpy.data.objects.remove(shape)


def test_default_sphere_in_full():
    add("uv_sphere", radius=2)
    bpy.ops.object.shade_smooth()
    found = recognise(active())
    (part,) = found.parts
    assert found.all_smooth and found.reason == "UV sphere, 32 segments, 16 rings"
    assert abs(part.radius - 2) < 1e-6 and np.allclose(part.centre, 0, atol=1e-6)
    assert np.allclose(part.frame, np.diag([-1, -1, 1]), atol=1e-5)  # Blender's u begins at -x


def test_default_cylinder_in_full():
    add("cylinder")
    side, *caps = recognise(active()).parts
    assert np.allclose([side.base, side.axis, side.e0], [[0, 0, -1], [0, 0, 1], [0, 1, 0]], atol=1e-5)
    assert np.allclose(side.uv.transform, [1, 0.5, 0, 0.5], atol=1e-5)
    assert sorted(cap.normal[2] for cap in caps) == pytest.approx([-1, 1])


def test_default_cone_has_a_planar_map():
    add("cone")
    side, _cap = recognise(active()).parts
    assert side.uv.planar and np.allclose(side.uv.transform, [0.48, 0.48, 0.01, 0.01], atol=1e-5)


def edited_sphere():
    add("uv_sphere").data.vertices[100].co *= 1.01


def sphere_without_faces():
    import bmesh  # in Blender as a module, there is one only once bpy is imported

    mesh = add("uv_sphere").data
    editable = bmesh.new()
    editable.from_mesh(mesh)
    bmesh.ops.delete(editable, geom=list(editable.faces)[::7], context="FACES")
    editable.to_mesh(mesh)
    editable.free()


def flipped_sphere():
    add("uv_sphere").data.flip_normals()


def joined_spheres():
    first, second = add("uv_sphere"), add("uv_sphere", location=(3, 0, 0))
    first.select_set(True)
    second.select_set(True)
    bpy.ops.object.join()


def bevelled_cylinder():
    modified(add("cylinder"), "BEVEL")


def subdivided_sphere():
    modified(add("uv_sphere"), "SUBSURF")


def subdivided_cube():
    modified(add("cube"), "SUBSURF")


def modified(shape, kind):
    """Apply a modifier with its defaults."""
    shape.modifiers.new("modifier", kind)
    bpy.context.view_layer.objects.active = shape
    bpy.ops.object.modifier_apply(modifier="modifier")


MESHES = {
    "a sphere with one vertex moved": (edited_sphere, "of the radius"),
    "a sphere without some faces": (sphere_without_faces, "missing"),
    "a sphere inside out": (flipped_sphere, "normals point inward"),
    "two spheres in one mesh": (joined_spheres, "not those of"),
    "a bevelled cylinder": (bevelled_cylinder, "neither a circle nor a straight line"),
    "a subdivided sphere": (subdivided_sphere, ""),
    "a subdivided cube": (subdivided_cube, "not those of"),
    "an icosahedron": (lambda: add("ico_sphere", subdivisions=1), "icosahedron"),
    "an octagonal prism": (lambda: add("cylinder", vertices=8), "8 sides are too few for a cylinder (12 or more)"),
    "a pyramid": (lambda: add("cone", vertices=11), "11 sides are too few for a cone (12 or more)"),
    "an octagon": (lambda: add("circle", vertices=8, fill_type="TRIFAN"), "8 sides are too few for a disc"),
    "a circle of edges": (lambda: add("circle"), "no faces"),
    "a cube": (lambda: add("cube"), "not those of"),
    "a torus": (lambda: add("torus"), "not those of"),
    "a grid": (lambda: add("grid"), "not those of"),
    "a plane": (lambda: add("plane"), "not those of"),
    "Suzanne": (lambda: add("monkey"), "not those of"),
}


@pytest.mark.parametrize("name", MESHES)
def test_stays_a_mesh(name):
    make, reason = MESHES[name]
    make()
    found = recognise(active())
    assert found.kind == "MESH" and reason in found.reason, found.reason


def test_loop_cuts_leave_a_cylinder():
    shape = add("cylinder", vertices=24, depth=3)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bisect(plane_co=(0, 0, 0.25), plane_no=(0, 0, 1))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(shape.data.vertices) == 72
    mesh = active()
    found = recognise(mesh)
    assert found.kind == "CYLINDER", found.reason
    assert_exact(mesh, found)


def test_a_solidified_disc_is_a_cylinder():
    modified(add("circle", fill_type="NGON"), "SOLIDIFY")
    found = recognise(active())
    assert found.kind == "CYLINDER" and abs(found.parts[0].length - 0.01) < 1e-6


def test_a_moved_map_still_fits():
    for name in ("cylinder", "cone", "circle"):
        shape = add(name, **({"fill_type": "NGON"} if name == "circle" else {}))
        layer = shape.data.uv_layers.active.uv
        for corner in layer:
            x, y = corner.vector
            corner.vector = (0.5 * x + 0.1, 3 * y - 0.2)
        mesh = active()
        assert_exact(mesh, recognise(mesh))


def test_a_turned_map_of_a_disc_turns_its_frame():
    shape = add("circle", fill_type="NGON")
    c, s = math.cos(0.4), math.sin(0.4)
    for corner in shape.data.uv_layers.active.uv:
        x, y = corner.vector
        corner.vector = (c * x - s * y, s * x + c * y)
    mesh = active()
    found = recognise(mesh)
    assert np.allclose(found.parts[0].e0, [c, -s, 0], atol=1e-4)
    assert_exact(mesh, found)
