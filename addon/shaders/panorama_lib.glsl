/* Pictures of all directions. */
#include "quadric_lib.glsl"

/* Equirectangular, as Blender maps it: the picture's centre is towards +X, its left half towards +Y. */
vec2 panorama_uv(vec3 direction)
{
  float across = length(direction.xy);
  float longitude = across > 0.0 ? atan(direction.y, direction.x) : 0.0;
  return vec2(0.5 - longitude / TWO_PI, 0.5 + atan(direction.z, across) * (2.0 / TWO_PI));
}
