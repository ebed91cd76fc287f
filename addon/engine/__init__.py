"""Conic's engine: exact shapes, ray-traced on the GPU. It knows nothing of Blender and needs numpy only.

from addon.engine import Camera, Light, Material, Scene, render
"""

from .changes import Change
from .errors import ConicError, DeviceError, SceneError
from .loaded_scene import LoadedScene
from .primitives import Cones, Cylinders, Discs, Planes, Spheres, Triangles
from .scene import Camera, Geometry, Image, Instances, Light, LightKind, Material, Scene, Visibility, World
from .session import Picture, Session, render
from .settings import Settings

__all__ = [
    "Camera",
    "Change",
    "Cones",
    "ConicError",
    "Cylinders",
    "DeviceError",
    "Discs",
    "Geometry",
    "Image",
    "Instances",
    "Light",
    "LightKind",
    "LoadedScene",
    "Material",
    "Picture",
    "Planes",
    "Scene",
    "SceneError",
    "Session",
    "Settings",
    "Spheres",
    "Triangles",
    "Visibility",
    "World",
    "render",
]
