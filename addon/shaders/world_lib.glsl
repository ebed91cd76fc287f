/* What a ray sees that hits nothing. */
#include "quadric_lib.glsl"
#ifdef HAS_WORLD_IMAGE
#include "image_lib.glsl"
#endif

/* Equirectangular, as Blender maps it: the picture's centre is towards +X, its left half towards +Y. */
vec2 world_uv(vec3 direction)
{
  float across = length(direction.xy);
  float longitude = across > 0.0 ? atan(direction.y, direction.x) : 0.0;
  return vec2(0.5 - longitude / TWO_PI, 0.5 + atan(direction.z, across) * (2.0 / TWO_PI));
}

vec3 world_radiance(vec3 direction)
{
#ifdef HAS_WORLD_IMAGE
  return frame_world_color * image_sample(int(frame_world_image), world_uv(direction)).rgb;
#else
  return frame_world_color;
#endif
}
