"""Which program draws a scene: its features and its source."""

from . import entries, shader_source
from .expression import constant_of
from .film import UNENDED_ALPHA
from .visibility import Visibility

#: Surfaces that a shadow ray may pass before it counts as blocked.
_SHADOW_SURFACES = 32
#: The feature of the shader that each way of shadows needs.
_SHADOW_FEATURES = {"TRANSPARENT": "TRANSPARENT_SHADOWS", "TINTED": "TINTED_SHADOWS"}


def counts_rays(settings):
    """Whether the program has counters of rays, or of those that it drops."""
    return settings.count_rays or settings.may_drop


def _outputs(settings):
    """What the program writes, an attachment of the film each."""
    counters = ("out_rays", "out_dropped") if counts_rays(settings) else ()
    guide = ("out_guide",) if settings.outlines else ()  # the last: of one sample only, it is not summed up
    return ("out_color", *counters, *guide)


def features_of(packed, settings, world_light):
    """The features of the shader that a packed scene needs with these settings; `world_light`: None for none."""
    features = packed.features | _world_features(packed, settings, world_light) | settings.film_features
    features -= {*_SHADOW_FEATURES.values()} - {_SHADOW_FEATURES.get(settings.shadows)}
    return frozenset(features | ({"COUNT_RAYS"} if counts_rays(settings) else set()))


def source_of(packed, settings, features, entry):
    """The source of the program that has these features."""
    constants = packed.constants | {
        "PATH_STACK_SIZE": settings.stack_size,
        "SHADOW_SURFACES": _SHADOW_SURFACES,
        "UNENDED_ALPHA": UNENDED_ALPHA,
    }
    programs = (("programs_lib.glsl", packed.programs),)
    return shader_source.program(entries.FILES[entry], features, constants, _outputs(settings), generated=programs)


def _world_features(packed, settings, world_light):
    if world_light is None:
        return set()
    if settings.samples_world:
        if constant_of(packed.world.radiance) is not None:
            return {"HAS_WORLD_LIGHT", "HAS_PLAIN_WORLD"}
        return {"HAS_WORLD_LIGHT"} | ({"HAS_WORLD_GLOSS"} if _gloss_asks_world(packed) else set())
    return {"HAS_HEMISPHERE_LIGHT"} | ({"HAS_AMBIENT_OCCLUSION"} if settings.use_ao else set())


def _gloss_asks_world(packed):
    """Whether what is rough asks bright parts of the world for light, as what is diffuse does: where the world is the
    same for all rays, and not the same everywhere."""
    rays = Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION
    programs, program = packed.world_programs
    alike = packed.world.visibility & rays == rays and "HAS_LIGHT_PATH" not in programs.features()
    return alike and program is not None and "HAS_ROUGHNESS" in packed.features
