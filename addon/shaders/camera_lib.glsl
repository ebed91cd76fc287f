/* The eye ray of a point of the raster. */
#include "ray_lib.glsl"

/* `pixel` in pixels from the lower left corner. `t_max` is the distance of the far plane from the ray's origin, which lies
 * on the near plane. */
Ray camera_ray(vec2 pixel, out float t_max)
{
  vec2 window = pixel * frame_raster.xy + frame_raster.zw;
  vec3 offset = window.x * frame_camera_right + window.y * frame_camera_up;
  bool parallel = frame_orthographic > 0.5;
  vec3 to_window = parallel ? frame_camera_forward : frame_camera_forward + offset;
  float per_depth = length(to_window);
  vec3 direction = to_window / per_depth;
  t_max = (frame_clip_end - frame_clip_start) * per_depth;
  vec3 origin = parallel ? frame_camera_origin + offset : frame_camera_origin;
  return ray_make(origin + (frame_clip_start * per_depth) * direction, direction, RAY_CAMERA);
}
