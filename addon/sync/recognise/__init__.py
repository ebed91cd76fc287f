"""Recognition of Blender's own added meshes as exact shapes (numpy only, no bpy).

``recognise(MeshArrays) -> Recognition`` says what a mesh is, in object space, and why. The vertices of
Blender's added meshes lie on the true shape, at regular places, and so does the uv map; everything else stays
a mesh.

- ``shapes``: the input and the output, plain data.
- ``revolution``: rings of vertices around an axis, with tips or caps (UV sphere, cylinder, cone, circle).
- ``profile``: which shape the rings make, and its parts.
- ``icosphere``: the ico sphere.
- ``uv_maps``: how the mesh's uv map relates to the uv of the exact shape.
"""

from .recognition import recognise
from .shapes import Cone, Cylinder, Disc, MeshArrays, Part, Recognition, Sphere, UvMap

__all__ = ["Cone", "Cylinder", "Disc", "MeshArrays", "Part", "Recognition", "Sphere", "UvMap", "recognise"]
