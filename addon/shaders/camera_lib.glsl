/* The eye ray of a point of the raster. */
#include "ray_lib.glsl"

/* `pixel` in pixels from the lower left corner. `t_max` is the distance of the far plane from the ray's origin, which lies
 * on the near plane. */
Ray camera_ray(vec2 pixel, out float t_max)
{
  vec2 window = pixel * frame.raster.xy + frame.raster.zw;
  vec3 offset = window.x * frame.camera_right + window.y * frame.camera_up;
  bool parallel = frame.orthographic > 0.5;
  vec3 to_window = parallel ? frame.camera_forward : frame.camera_forward + offset;
  float per_depth = length(to_window);
  vec3 direction = to_window / per_depth;
  t_max = (frame.clip_end - frame.clip_start) * per_depth;
  vec3 origin = parallel ? frame.camera_origin + offset : frame.camera_origin;
  return Ray(origin + (frame.clip_start * per_depth) * direction, direction);
}
