"""Shader nodes as the lobes of an engine material, and what is said about the rest."""

import bpy
import pytest

from tests.blender.building import Constants, add_camera, material, node, of_node, quad, shaded, sync

METAL_BASE = (0.9, 0.6, 0.3, 1.0)


def test_diffuse():
    read = of_node("BsdfDiffuse", Color=(0.2, 0.4, 0.6, 1.0))
    assert read.diffuse == pytest.approx((0.2, 0.4, 0.6))
    assert read.reflect == read.transmit == read.glow == read.highlight == (0.0, 0.0, 0.0) and not read.fresnel


def test_smooth_plastic_reflects_by_fresnel():
    read = of_node("BsdfPrincipled", Base_Color=(0.2, 0.4, 0.6, 1.0), Roughness=0.0, IOR=1.4)
    assert read.fresnel and read.ior == pytest.approx(1.4)
    assert read.diffuse == pytest.approx((0.2, 0.4, 0.6)) and read.reflect == pytest.approx((1.0, 1.0, 1.0))


def test_rough_plastic_reflects_by_fresnel_too():
    read = of_node("BsdfPrincipled", Base_Color=(0.5, 0.5, 0.5, 1.0), Roughness=0.5, IOR=1.5)
    assert read.fresnel and read.ior == pytest.approx(1.5) and read.roughness == pytest.approx(0.5)
    assert read.diffuse == pytest.approx((0.5,) * 3) and read.reflect == pytest.approx((1.0,) * 3)
    assert read.highlight == read.transmit == read.coat == read.metallic == (0.0, 0.0, 0.0)


def test_specular_level_changes_the_index_of_an_opaque_body():
    none = of_node("BsdfPrincipled", Roughness=0.0, Specular_IOR_Level=0.0)
    assert none.fresnel_ior == pytest.approx(1.0), "Fresnel's reflectance is 0"


def test_specular_level_doubled():
    twice = of_node("BsdfPrincipled", Roughness=0.0, Specular_IOR_Level=1.0)
    assert ((twice.fresnel_ior - 1.0) / (twice.fresnel_ior + 1.0)) ** 2 == pytest.approx(0.08)
    assert twice.ior == pytest.approx(1.5)


def test_smooth_metal_is_a_mirror_without_fresnel():
    read = of_node("BsdfPrincipled", Base_Color=METAL_BASE, Metallic=1.0, Roughness=0.0)
    assert read.metallic == pytest.approx(METAL_BASE[:3])
    assert read.diffuse == read.reflect == read.transmit == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("roughness", (0.0, 0.3, 1.0))
def test_metal_of_principled_grows_white_and_is_tinted_near_the_edge(roughness):
    read = of_node(
        "BsdfPrincipled", Base_Color=METAL_BASE, Metallic=1.0, Roughness=roughness, Specular_Tint=(0.2, 0.5, 1.0, 1.0)
    )
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and read.reflect == (0.0, 0.0, 0.0)
    assert read.grazing == pytest.approx((1.0,) * 3) and read.edge == pytest.approx((0.2, 0.5, 1.0))
    assert read.roughness == pytest.approx(roughness) and read.diffuse == (0.0, 0.0, 0.0)


def test_half_a_metal_is_half_a_plastic():
    read = of_node("BsdfPrincipled", Base_Color=METAL_BASE, Metallic=0.5, Roughness=0.4, IOR=1.5)
    assert read.metallic == read.diffuse == pytest.approx([0.5 * c for c in METAL_BASE[:3]])
    assert read.grazing == read.reflect == pytest.approx((0.5,) * 3) and read.roughness == pytest.approx(0.4)
    assert read.diffuse_covered == pytest.approx(1.0), "all of the plastic's body"


def test_glossy_reflects_the_same_at_all_angles():
    read = of_node("BsdfAnisotropic", Color=METAL_BASE, Roughness=0.4)
    assert read.metallic == read.grazing == pytest.approx(METAL_BASE[:3])
    assert read.roughness == pytest.approx(0.4)


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfMetallic"), reason="since Blender 4.3")
def test_metallic_node():
    read = of_node("BsdfMetallic", Base_Color=METAL_BASE, Edge_Tint=(0.3, 0.4, 0.5, 1.0), Roughness=0.2)
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and read.edge == pytest.approx((0.3, 0.4, 0.5))


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfMetallic"), reason="since Blender 4.3")
def test_metallic_node_by_index_and_extinction():
    def build(tree, output):
        made = node(tree, "BsdfMetallic", output.inputs["Surface"], Roughness=0.2)
        made.fresnel_type = "PHYSICAL_CONDUCTOR"
        made.inputs["IOR"].default_value, made.inputs["Extinction"].default_value = (0.2, 1.0, 1.5), (3.0, 2.0, 0.0)

    read, synced = shaded(build)
    assert not synced.messages
    expected = [((n - 1.0) ** 2 + k**2) / ((n + 1.0) ** 2 + k**2) for n, k in ((0.2, 3.0), (1.0, 2.0), (1.5, 0.0))]
    assert read.metallic == pytest.approx(expected)
    schlick = expected[2] + (1.0 - expected[2]) * (6.0 / 7.0) ** 5
    assert read.edge[2] * schlick == pytest.approx(0.4543, abs=1e-3), "a dielectric of 1.5 at 81.79 degrees"


def test_coat_lies_over_all_with_a_roughness_of_its_own():
    read = of_node(
        "BsdfPrincipled",
        Metallic=1.0,
        Roughness=0.5,
        Coat_Weight=0.7,
        Coat_Roughness=0.1,
        Coat_IOR=1.8,
        Coat_Tint=(0.9, 0.5, 0.1, 1.0),
    )
    assert read.coat == pytest.approx((0.7,) * 3) and read.coat_tint == pytest.approx((0.9, 0.5, 0.1))
    assert (read.coat_roughness, read.coat_ior, read.roughness) == pytest.approx((0.1, 1.8, 0.5))


def test_diffuse_roughness_and_translucent():
    assert of_node("BsdfDiffuse", Roughness=0.3).diffuse_roughness == pytest.approx(0.3)
    bpy.data.objects.remove(bpy.data.objects["quad"])
    read = of_node("BsdfTranslucent", Color=(0.2, 0.4, 0.6, 1.0))
    assert read.translucent == pytest.approx((0.2, 0.4, 0.6)) and read.diffuse == (0.0, 0.0, 0.0)


def test_holdout():
    assert of_node("Holdout").holdout == 1.0


def test_changing_constants_changes_no_structure():
    """Nothing is decided by a value: zero or not, a socket is a parameter in the same place."""

    def structure(**inputs):
        read, _ = shaded(lambda tree, output: node(tree, "BsdfPrincipled", output.inputs["Surface"], **inputs))
        bpy.data.objects.remove(bpy.data.objects["quad"])
        (made,) = (m for m in bpy.data.materials)
        bpy.data.materials.remove(made)
        return {name: type(value) for name, value in vars(read.material).items()}

    plain = structure()
    for inputs in (
        {"Metallic": 0.5},
        {"Transmission_Weight": 1.0, "IOR": 0.7},
        {"Coat_Weight": 1.0, "Coat_Tint": METAL_BASE, "Alpha": 0.3},
        {"Specular_IOR_Level": 0.0, "Specular_Tint": METAL_BASE, "Emission_Strength": 3.0},
    ):
        assert structure(**inputs) == plain


def test_multiscatter_is_a_distribution():
    for node_type, distribution, expected in (
        ("BsdfAnisotropic", "MULTI_GGX", True),
        ("BsdfAnisotropic", "GGX", False),
        ("BsdfGlass", "MULTI_GGX", True),
        ("BsdfGlass", "GGX", False),
        ("BsdfRefraction", "GGX", False),
        ("BsdfPrincipled", "MULTI_GGX", True),
        ("BsdfPrincipled", "GGX", False),
    ):
        read, synced = shaded(
            lambda tree, output, kind=node_type, name=distribution: setattr(
                node(tree, kind, output.inputs["Surface"], Roughness=0.5), "distribution", name
            )
        )
        assert bool(read.multiscatter) is expected and not synced.messages
        bpy.data.objects.remove(bpy.data.objects["quad"])


def test_another_distribution_is_reported():
    _, synced = shaded(
        lambda tree, output: setattr(
            node(tree, "BsdfAnisotropic", output.inputs["Surface"]), "distribution", "BECKMANN"
        )
    )
    assert len(synced.warnings("distribution", "GGX")) == 1 == len(synced.messages)


def test_parts_of_different_roughness_are_reported():
    def build(tree, output):
        made = node(tree, "AddShader", output.inputs["Surface"])
        node(tree, "BsdfAnisotropic", made.inputs[0], Color=(0.2, 0.2, 0.2, 1.0), Roughness=0.0)
        node(tree, "BsdfAnisotropic", made.inputs[1], Color=(0.6, 0.6, 0.6, 1.0), Roughness=0.4)

    read, synced = shaded(build)
    assert read.roughness == pytest.approx(0.3) and read.metallic == pytest.approx((0.8,) * 3)
    assert len(synced.warnings("mean roughness")) == 1 == len(synced.messages)


def test_glass_of_principled_takes_the_root_at_each_surface():
    read = of_node(
        "BsdfPrincipled", Base_Color=(0.25, 0.81, 1.0, 1.0), Transmission_Weight=1.0, Roughness=0.0, IOR=1.33
    )
    assert read.fresnel and read.ior == pytest.approx(1.33)
    assert read.transmit == pytest.approx((0.5, 0.9, 1.0)) and read.reflect == pytest.approx((1.0, 1.0, 1.0))
    assert read.diffuse == (0.0, 0.0, 0.0)


def test_glass_bsdf_colors_reflection_too():
    read = of_node("BsdfGlass", Color=(0.5, 0.9, 1.0, 1.0), IOR=1.45)
    assert read.fresnel and read.ior == pytest.approx(1.45)
    assert read.transmit == read.reflect == pytest.approx((0.5, 0.9, 1.0))


def test_refraction_does_not_reflect():
    read = of_node("BsdfRefraction", Color=(0.5, 0.9, 1.0, 1.0), IOR=1.2, Roughness=0.0)
    assert not read.transmit_covered and read.ior == pytest.approx(1.2) and read.reflect == (0.0, 0.0, 0.0)
    assert read.transmit == pytest.approx((0.5, 0.9, 1.0))


def test_transparent_does_not_bend():
    read = of_node("BsdfTransparent", Color=(0.5, 0.9, 1.0, 1.0))
    assert not read.fresnel and read.ior == 1.0 and read.transmit == pytest.approx((0.5, 0.9, 1.0))


def test_alpha():
    read = of_node("BsdfPrincipled", Base_Color=(1.0, 1.0, 1.0, 1.0), Roughness=1.0, Alpha=0.25, Specular_IOR_Level=0.0)
    assert read.transmit == pytest.approx((0.75,) * 3) and read.ior == 1.0
    assert read.diffuse == pytest.approx((0.25,) * 3)


def test_emission():
    read = of_node("Emission", Color=(1.0, 0.5, 0.25, 1.0), Strength=8.0)
    assert read.glow == pytest.approx((8.0, 4.0, 2.0)) and read.diffuse == (0.0, 0.0, 0.0)


def test_emission_of_principled():
    read = of_node("BsdfPrincipled", Emission_Color=(1.0, 0.5, 0.25, 1.0), Emission_Strength=2.0)
    assert read.glow == pytest.approx((2.0, 1.0, 0.5))


def test_glossy_is_a_metal():
    node_type = "BsdfGlossy" if bpy.app.version >= (5, 0, 0) else "BsdfAnisotropic"
    read = of_node(node_type, Color=METAL_BASE, Roughness=0.0)
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and not read.fresnel


def test_volume_absorption():
    def build(tree, output):
        node(tree, "BsdfGlass", output.inputs["Surface"])
        node(tree, "VolumeAbsorption", output.inputs["Volume"], Color=(0.0, 0.5, 1.0, 1.0), Density=2.0)

    read, synced = shaded(build)
    assert read.absorption == pytest.approx((2.0, 1.0, 0.0)) and not synced.messages


def test_volume_alone_has_no_surface():
    read, _ = shaded(lambda tree, output: node(tree, "VolumeAbsorption", output.inputs["Volume"], Density=2.0))
    assert read.transmit == (1.0, 1.0, 1.0) and read.ior == 1.0


def test_rough_glass_is_rough_on_both_ways():
    read = of_node("BsdfGlass", Roughness=0.3)
    assert read.roughness == read.transmit_roughness == pytest.approx(0.3)


def test_rough_refraction():
    read, synced = shaded(lambda tree, output: node(tree, "BsdfRefraction", output.inputs["Surface"], Roughness=0.3))
    assert len(synced.warnings("distribution")) == 1 == len(synced.messages), "Beckmann's, which the node begins with"
    assert read.transmit_roughness == pytest.approx(0.3) and read.roughness == 0.0


def test_inputs_that_are_not_rendered_are_named_together():
    def build(tree, output):
        principled = node(tree, "BsdfPrincipled", output.inputs["Surface"], Subsurface_Weight=0.5, Sheen_Weight=1.0)
        node(tree, "Bump", principled.inputs["Coat Normal"])

    _, synced = shaded(build)
    assert len(synced.messages) == 1
    assert synced.warnings("Coat Normal, Subsurface Weight and Sheen Weight are not rendered")


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="since Blender 5.0 every material has nodes")
def test_without_nodes():
    add_camera()
    made = bpy.data.materials.new("plain")
    made.use_nodes = False
    made.diffuse_color, made.metallic, made.roughness = METAL_BASE, 1.0, 0.0
    quad().data.materials.append(made)
    (read,) = sync().scene.materials
    assert Constants(read).metallic == pytest.approx(METAL_BASE[:3])


def test_material_override_of_the_view_layer():
    add_camera()
    made, tree, output = material("clay")
    node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(0.1, 0.2, 0.3, 1.0))
    bpy.context.view_layer.material_override = made
    quad().data.materials.append(material("hidden")[0])
    (read,) = sync().scene.materials
    assert Constants(read).diffuse == pytest.approx((0.1, 0.2, 0.3))
