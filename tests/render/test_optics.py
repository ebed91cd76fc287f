"""Energy and optics against formulas: what a picture must be, whatever renders it."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Image,
    Instances,
    Light,
    Material,
    Scene,
    Settings,
    Spheres,
    Triangles,
    World,
    render,
)

from .probe import GlassBalls, along, fresnel

DEPTH = 33
DEEP = Settings(max_depth=DEPTH, weight_cutoff=0.0)
GLASS = Material.glass()


def side_view(height=2.2, width=48, rows=36):
    """An orthographic camera at -Y, and where its pixels' rays are: x, z (rows, width)."""
    camera = Camera.orthographic_at((0.0, -5.0, 0.0), (0.0, 0.0, 0.0), height, aspect=width / rows)
    z, x = np.mgrid[:rows, :width] + 0.5
    return camera, (x / width - 0.5) * height * width / rows, (z / rows - 0.5) * height


def picture(device, scene, settings=DEEP, width=48, rows=36):
    """Pixels (rows, width, 3) float64."""
    return render(scene, width, rows, settings, device=device).pixels[..., :3].astype(np.float64)


# A body in a white furnace takes nothing and adds nothing.


def test_glass_ball_in_a_furnace(device):
    """Every pixel is 1 but for what is still inside the ball at the last depth: (1 - F) F^(depth - 2)."""
    camera, x, z = side_view()
    scene = Scene(camera=camera, world=World((1.0, 1.0, 1.0)), materials=[GLASS])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    distance = np.hypot(x, z)
    share = fresnel(np.sqrt(np.clip(1.0 - distance**2, 0.0, 1.0)), 1.0, 1.5)
    inside = np.where(distance < 1.0, (1.0 - share) * share ** (DEPTH - 2), 0.0)
    away_from_edge = np.abs(distance - 1.0) > 2e-3
    error = np.abs(picture(device, scene) - (1.0 - inside)[..., None]).max(axis=-1)
    assert error[away_from_edge].max() < 2e-5


def cube(material, lower=(-0.5, -0.5, -0.5), size=1.0):
    """The 12 Triangles of a cube."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * size + lower
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    faces = corners[np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])]
    return Triangles(p0=faces[:, 0], p1=faces[:, 1], p2=faces[:, 2], material=material)


def solids(scene, materials=(0, 0, 0, 0)):
    """A cylinder, a cone, a cube of triangles and an ellipsoid, apart from each other."""
    scene.add_cylinders((-1.0, 0.1, 0.1), (-0.4, -0.3, 0.8), 0.35, materials[0])
    scene.add_cones((-0.8, 0.0, -0.9), (-0.7, 0.1, -0.1), 0.4, 0.1, materials[1])
    scene.add(cube(materials[2], (0.35, -0.3, -0.9), 0.6))
    matrix = np.array([[0.5, 0.2, 0.0, 0.7], [0.0, 0.4, 0.1, 0.0], [0.0, 0.0, 0.45, 0.4], [0.0, 0.0, 0.0, 1.0]])
    scene.instances.append(Instances(Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=1.0)), matrix, (materials[3],)))


def test_no_solid_makes_energy(device):
    """Glass of all kinds in a furnace: at most 1, and nearly all of it where rays do not stay inside."""
    scene = Scene(camera=side_view()[0], world=World((1.0, 1.0, 1.0)), materials=[GLASS])
    solids(scene)
    pixels = picture(device, scene)
    assert pixels.max() < 1.0 + 2e-5
    assert np.quantile(pixels, 0.1) > 0.99


def test_mirrors_in_a_furnace(device):
    scene = Scene(camera=side_view()[0], world=World((1.0, 1.0, 1.0)), materials=[Material.mirror()])
    solids(scene)
    assert np.abs(picture(device, scene) - 1.0).max() < 1e-6


def test_sky_does_not_light_diffuse_surfaces(device):
    """The paper's light model has no light but lights."""
    camera, x, z = side_view()
    scene = Scene(camera=camera, world=World((1.0, 1.0, 1.0)), materials=[Material(diffuse=1.0)])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    assert (picture(device, scene)[np.hypot(x, z) < 0.99] == 0.0).all()


def test_a_body_of_the_index_of_air_is_not_seen(device):
    """Nor is a ball of glass in a ball of glass, where only the outer one bends."""
    camera = side_view()[0]
    stripes = np.zeros((16, 32, 3))
    stripes[:, ::2] = (0.2, 0.9, 0.4)

    def seen(*balls):
        scene = Scene(camera=camera, materials=[Material.glass(ior=1.0), GLASS, Material.glass()])
        scene.world = World((1.0, 1.0, 1.0), scene.add_image(Image(stripes)))
        scene.add_discs((9.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.1)  # out of sight: the same program for all
        for radius, material in balls:
            scene.add_spheres((0.0, 0.0, 0.0), radius, material)
        return picture(device, scene)

    assert np.abs(seen((1.0, 0)) - seen((0.001, 0))).max() < 1e-4
    assert np.abs(seen((1.0, 1), (0.5, 2)) - seen((1.0, 1))).max() < 1e-4


# Plates.


def plate(thickness, material, world=0.0, glow=1.0):
    """A plate between two infinite planes, over a plane that glows."""
    scene = Scene(world=World((world,) * 3), materials=[material, Material(diffuse=0.0, glow=glow)])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_plane((0.0, 0.0, -thickness), (0.0, 0.0, -1.0), 0)
    scene.add_plane((0.0, 0.0, -5.0), (0.0, 0.0, 1.0), 1)
    return scene


@pytest.mark.parametrize("degrees", [0.0, 30.0, 56.31, 75.0])
@pytest.mark.parametrize("absorption", [(0.0, 0.0, 0.0), (0.1, 0.7, 2.0)], ids=["clear", "absorbing"])
def test_plate(device, degrees, absorption):
    """All reflections between the two sides: t = (1 - R)^2 a / (1 - R^2 a^2), r = R + R (1 - R)^2 a^2 / (1 - R^2 a^2),
    where a is what the way through the plate leaves; 56.31 degrees is Brewster's angle."""
    angle = np.radians(degrees)
    direction = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    cos_t = np.sqrt(1.0 - (np.sin(angle) / 1.5) ** 2)
    share = float(fresnel(np.cos(angle), 1.0, 1.5))
    left = np.exp(-np.array(absorption) * 0.8 / cos_t)
    through = (1.0 - share) ** 2 * left / (1.0 - (share * left) ** 2)
    back = share + share * left * through
    for world, glow, expected in ((0.0, 1.0, through), (1.0, 0.0, back)):
        scene = plate(0.8, Material.glass(absorption=absorption), world, glow)
        assert along(device, scene, -3.0 * direction, direction, DEEP) == pytest.approx(expected, abs=1e-5)
    if not any(absorption):
        assert through == pytest.approx((1.0 - share) / (1.0 + share))  # the formula itself


def test_total_reflection_from_within(device):
    """A fan of rays from inside glass to its flat surface: Fresnel's curve up to the critical angle, all beyond it."""
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[GLASS, Material(diffuse=0.0, glow=0.25)])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_plane((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 1)
    scene.camera = Camera.look_at((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), angle=1.0, aspect=80.0)
    left, right, _, _ = scene.camera.window
    offset = left + (right - left) * (np.arange(64) + 0.5) / 64
    directions = offset[:, None] * scene.camera.matrix[:3, 0] - scene.camera.matrix[:3, 2]
    cos_i = directions[:, 2] / np.linalg.norm(directions, axis=1)
    share = fresnel(cos_i, 1.5, 1.0)
    assert 10 < (share == 1.0).sum() < 50, "the fan does not span the critical angle"
    values = picture(device, scene, width=64, rows=1)[0]
    near_critical = np.abs(cos_i - np.sqrt(1.0 - 1.0 / 1.5**2)) < 1e-3
    assert np.abs(values - (1.0 - share + 0.25 * share)[:, None])[~near_critical].max() < 1e-5


@pytest.mark.parametrize(("ior", "turned"), [(1.5, True), (1.35, False)])
def test_prism(device, ior, turned):
    """A right-angled prism turns a ray by total reflection when 45 degrees is beyond the critical angle."""
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material.glass(ior=ior)])
    scene.add_material(Material(diffuse=0.0, glow=(0.0, 1.0, 0.0)))
    a, b, c = np.array([[(x, y, z) for y in (-1.0, 1.0)] for x, z in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))])
    faces = [(a[0], b[0], c[0]), (a[1], c[1], b[1])]  # ends
    for p, q in ((b, a), (a, c), (c, b)):  # bottom, the leg at x = 0, the long side
        faces += [(p[0], q[0], q[1]), (p[0], q[1], p[1])]
    faces = np.array(faces)
    center = faces.reshape(-1, 3).mean(axis=0)
    outward = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    assert (np.einsum("ij,ij->i", outward, faces[:, 0] - center) > 0.0).all(), "the prism is built inside out"
    scene.add_triangles(faces[:, 0], faces[:, 1], faces[:, 2], 0)
    scene.add_discs((0.45, 0.0, -1.0), (0.0, 0.0, 1.0), 0.3, 1)  # where the turned ray comes out
    value = along(device, scene, (-2.0, 0.0, 0.55), (1.0, 0.0, 0.0), DEEP)[1]
    flat = float(fresnel(1.0, 1.0, ior))
    if turned:  # legs reflect a little of it to and fro
        assert value == pytest.approx((1.0 - flat) / (1.0 + flat), abs=1e-5)
    else:
        at_long_side = float(fresnel(np.sqrt(0.5), ior, 1.0))
        assert value == pytest.approx((1.0 - flat) ** 2 * at_long_side / (1.0 - (at_long_side * flat) ** 2), abs=1e-5)
        assert at_long_side < 0.2


# Absorption and nested media.


def test_absorption_along_chords(device):
    """A ball of the index of air: exp(-sigma times the chord), white light around it."""
    camera, x, z = side_view()
    material = Material.glass(ior=1.0, absorption=(0.2, 1.0, 3.0))
    scene = Scene(camera=camera, world=World((1.0, 1.0, 1.0)), materials=[material])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    chord = 2.0 * np.sqrt(np.clip(1.0 - x**2 - z**2, 0.0, 1.0))
    assert np.abs(picture(device, scene) - np.exp(-chord[..., None] * material.absorption)).max() < 1e-3  # at the edge
    assert np.median(np.abs(picture(device, scene) - np.exp(-chord[..., None] * material.absorption))) < 1e-6


@pytest.mark.parametrize("number", range(4), ids=["cylinder", "cone", "cube", "ellipsoid"])
def test_absorption_is_as_long_as_the_body(device, number):
    """The same along a ray through each solid, against the distance between its two intersections."""
    directions = {0: (0.2, 1.0, 0.1), 1: (0.1, 1.0, -0.2), 2: (0.15, 1.0, 0.2), 3: (-0.1, 1.0, 0.1)}
    centers = {0: (-0.7, -0.1, 0.45), 1: (-0.75, 0.05, -0.5), 2: (0.65, 0.0, -0.6), 3: (0.7, 0.0, 0.4)}
    direction = np.array(directions[number]) / np.linalg.norm(directions[number])
    origin = np.array(centers[number]) - 3.0 * direction
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[Material.glass(ior=1.0, absorption=(1.0, 0.5, 2.0))])
    solids(scene)
    enter = first_hit(scene, origin, direction)
    leave = enter + 1e-6 + first_hit(scene, origin + (enter + 1e-6) * direction, direction)
    assert 0.2 < leave - enter < 1.5
    expected = np.exp(-(leave - enter) * np.array([1.0, 0.5, 2.0]))
    # A ray starts a few roundings off its surface, which shortens it.
    assert along(device, scene, origin, direction, DEEP) == pytest.approx(expected, abs=4e-5)


def first_hit(scene, origin, direction):
    """Distance to the first surface by the float64 reference of each kind."""
    nearest = np.inf
    placed = [(matrix, block.geometry) for block in scene.instances for matrix in block.matrices]
    for matrix, geometry in [(np.eye(4), scene.shapes), *placed]:
        inverse = np.linalg.inv(matrix)
        o, d = inverse[:3, :3] @ origin + inverse[:3, 3], inverse[:3, :3] @ direction
        scale = np.linalg.norm(d)
        for _, part in geometry.kinds():
            rows = (len(part), 3)
            t = part.reference_hit(np.broadcast_to(o, rows), np.broadcast_to(d / scale, rows)) / scale
            nearest = min(nearest, float(t.min()))
    return nearest


def test_nested_media_against_float64(device):
    """A ball of coloured glass that holds coloured water, which holds a bubble, and a bubble of its own."""
    balls = [
        ((0.0, 0.0, 0.0), 1.0, 1.5, (0.1, 0.3, 0.5)),
        ((0.25, 0.0, 0.1), 0.6, 1.33, (0.6, 0.2, 0.1)),
        ((0.3, -0.1, 0.2), 0.2, 1.0, (0.0, 0.0, 0.0)),
        ((-0.6, -0.2, -0.2), 0.22, 1.0, (0.0, 0.0, 0.0)),
    ]
    camera, x, z = side_view(width=16, rows=12)
    scene = Scene(camera=camera, world=World((1.0, 1.0, 1.0)))
    for center, radius, index, absorption in balls:
        scene.add_spheres(center, radius, scene.add_material(Material.glass(ior=index, absorption=absorption)))
    reference, depth = GlassBalls(balls), 8
    expected = [
        reference.light(np.array([a, -5.0, b]), np.array([0.0, 1.0, 0.0]), depth)
        for a, b in zip(x.ravel(), z.ravel(), strict=True)
    ]
    settings = Settings(max_depth=depth, weight_cutoff=0.0)
    error = np.abs(picture(device, scene, settings, 16, 12) - np.reshape(expected, (12, 16, 3)))
    assert np.quantile(error, 0.98) < 2e-5
    assert error.max() < 2e-2  # a ray that just passes the edge of a ball


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["front", "back"])
def test_opaque_surface_in_a_medium(device, side):
    """The light of a disc in the middle of an absorbing ball is absorbed on its way out, seen from either side."""
    absorption = np.array([0.5, 1.0, 1.5])
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material.glass(ior=1.0, absorption=absorption)])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    scene.add_discs((0.0, 0.0, 0.0), (0.0, side, 0.0), 0.5, scene.add_material(Material(diffuse=0.0, glow=1.0)))
    value = along(device, scene, (0.0, -3.0, 0.0), (0.0, 1.0, 0.0), DEEP)
    assert value == pytest.approx(np.exp(-absorption), abs=1e-5)


def test_the_eye_in_glass(device):
    """From the middle of an absorbing ball: half its thickness, and the share that its surface lets out, though the ray
    was never seen entering."""
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[Material.glass(absorption=(0.5, 1.0, 1.5))])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    left = np.exp(-np.array([0.5, 1.0, 1.5]))
    share = float(fresnel(1.0, 1.5, 1.0))
    expected = (1.0 - share) * left / (1.0 - share * left**2)
    assert along(device, scene, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), DEEP) == pytest.approx(expected, abs=1e-5)


def test_a_body_of_several_materials(device):
    """A glass cube is entered by one of its materials and left by another: the same picture as with one."""
    checks = np.indices((8, 16)).sum(axis=0) % 2 * 0.8
    turn = np.array([[0.8, -0.6, 0.0, 0.0], [0.48, 0.64, 0.6, 0.0], [-0.36, -0.48, 0.8, 0.0], [0.0, 0.0, 0.0, 1.0]])
    pictures = []
    for slots in ((0,), (0, 1, 2)):
        body = Instances(Geometry(cube(np.arange(12) % len(slots))), turn, slots)
        scene = Scene(camera=side_view()[0], materials=[GLASS] * 3, instances=[body])
        sky = scene.add_image(Image(np.repeat(checks[..., None], 3, axis=-1)))
        scene.world = World((1.0, 1.0, 1.0), sky)
        pictures.append(picture(device, scene))
    assert np.ptp(pictures[0]) > 0.3
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-6


# Bounds of the work: stack, depth, weight.


def glass_heap(camera=None):
    """Twelve balls of glass close together: rays that branch again and again."""
    scene = Scene(camera=camera or side_view()[0], world=World((0.6, 0.7, 0.9)), materials=[GLASS])
    rows = np.arange(12)
    centers = np.stack([rows % 4 * 0.55 - 0.8, rows % 3 * 0.5, rows // 4 * 0.6 - 0.6], axis=-1)
    scene.add_spheres(centers, 0.27)
    return scene


def test_a_full_stack_is_reported(device):
    scene = glass_heap()
    small = render(scene, 48, 36, Settings(max_depth=20, stack_limit=2, weight_cutoff=0.0), device=device)
    dropped = small.statistics["rays"]["dropped"]
    assert dropped > 0
    assert any(str(dropped) in warning and "dropped" in warning for warning in small.warnings)
    large = render(scene, 48, 36, Settings(max_depth=20, weight_cutoff=0.0, count_rays=True), device=device)
    assert large.statistics["rays"]["dropped"] == 0
    assert not large.warnings
    assert (small.pixels - large.pixels).max() < 1e-6  # what is dropped is missing, nothing is added
    assert (large.pixels - small.pixels).max() > 1e-4


def test_weight_cutoff_costs_little(device):
    scene = glass_heap()
    exact, cut = (picture(device, scene, Settings(max_depth=20, weight_cutoff=w)) for w in (0.0, 1.0 / 512.0))
    error = exact - cut
    assert error.min() > -1e-6
    assert 0.0 < error.mean() < 1.0 / 512.0
    assert error.max() < 0.03


def test_less_depth_is_darker(device):
    scene = glass_heap()
    shallow, deep = (picture(device, scene, Settings(max_depth=depth, weight_cutoff=0.0)) for depth in (8, 20))
    assert (deep - shallow).min() > -1e-6
    assert (deep - shallow).max() > 1e-3


# Counters, by hand.


def counted(device, scene, **settings):
    settings = {"max_depth": 8, "weight_cutoff": 0.0, "count_rays": True} | settings
    scene.camera = Camera.orthographic_at((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 3.0, up=(0.0, 1.0, 0.0), aspect=4.0 / 3.0)
    return render(scene, 4, 3, Settings(**settings), device=device).statistics["rays"]


def rays(eye, eye_hit, reflect, refract, shadow):
    return dict(eye=eye, eye_hit=eye_hit, reflect=reflect, refract=refract, shadow=shadow, dropped=0)


def test_counts_of_a_plate_over_a_floor(device):
    """4 x 3 pixels straight down, one light above and one below the floor."""
    scene = plate(0.5, Material(diffuse=0.0, transmit=1.0, fresnel=False))
    scene.materials[1] = Material(diffuse=0.5)
    scene.add_light(Light.sun((0.0, 0.3, 1.0), 1.0))
    scene.add_light(Light.constant((0.0, 0.0, -9.0)))
    assert counted(device, scene) == rays(12, 12, 0, 24, 12)
    assert counted(device, scene, samples=3) == rays(36, 36, 0, 72, 36)
    assert counted(device, scene, corner_rays=True) == rays(20, 20, 0, 40, 20)
    assert counted(device, scene, max_depth=2) == rays(12, 12, 0, 12, 0)
    # Half of it is reflected at the first side (12 mirror rays that miss), the other half passes (12); at the second
    # side it is reflected (12) and refracted (12); depth 3 ends there, and 12 rays hit the floor.
    scene.materials[0] = Material(diffuse=0.0, reflect=0.5, transmit=0.5, fresnel=False)
    assert counted(device, scene, max_depth=3) == rays(12, 12, 24, 24, 12)


def test_counts_of_a_miss(device):
    scene = Scene(materials=[Material()])
    scene.add_light(Light.sun((0.0, 0.0, 1.0), 1.0))
    scene.add_plane((0.0, 0.0, 9.0), (0.0, 0.0, 1.0), 0)  # behind the camera
    assert counted(device, scene) == rays(12, 0, 0, 0, 0)


def test_samples_that_a_driver_gives_up_are_told(device):
    """Many lights, mirror balls that see each other: all lights at once are the sum of the parts, or a warning says
    that they are not, as on a software rasteriser, which ends loops after 65535 turns."""
    rng = np.random.default_rng(8)
    turns = np.arange(48) * 2.4
    lights = [Light.point((6.0 * np.cos(a), 6.0 * np.sin(a), 4.0 * np.sin(7.0 * a)), 10.0) for a in turns]
    mirrors = Material(diffuse=0.5, reflect=0.98, fresnel=False)
    scene = Scene(camera=side_view()[0], world=World((0.0, 0.0, 0.0)), materials=[mirrors])
    scene.add_spheres(rng.normal(size=(4000, 3)), 0.06)
    scene.add_spheres((0.0, 0.0, 0.0), 20.0)  # a room that no ray leaves
    at_once, *parts = (
        render(replace(scene, lights=some), 12, 9, Settings(max_depth=60, weight_cutoff=0.0), device=device)
        for some in (lights, *(lights[i : i + 6] for i in range(0, 48, 6)))
    )
    assert not any(part.warnings for part in parts)
    assert (at_once.pixels[..., 3] == 1.0).all()
    error = np.abs(at_once.pixels - sum(part.pixels for part in parts))[..., :3].max()
    assert error < 1e-3 or any("gives up" in warning for warning in at_once.warnings)
    if "llvmpipe" in device.name:
        assert error > 1e-3, "too little work for what this test is about"


def test_single_sheet_is_no_border_of_a_medium(device):
    """Glass behind a pane without thickness is as much glass as without it; the pane takes its own share."""
    absorption = np.array((0.1, 0.3, 0.5))
    ball = Material(diffuse=0.0, transmit=1.0, ior=1.5, absorption=tuple(absorption))
    pane = Material(diffuse=0.0, transmit=1.0, ior=1.5, absorption=(9.0, 9.0, 9.0), bounds_body=False)
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[ball, pane])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0, 0)
    scene.add_discs((0.0, -3.0, 0.0), (0.0, -1.0, 0.0), 2.0, 1)
    color = along(device, scene, (0.0, -5.0, 0.0), (0.0, 1.0, 0.0), Settings(max_depth=8, weight_cutoff=0.0))
    assert color == pytest.approx((1.0 - 0.04) ** 3 * np.exp(-2.0 * absorption), rel=1e-4)
