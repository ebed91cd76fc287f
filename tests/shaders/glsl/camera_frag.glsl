/* The eye ray through a point of the raster; a = (x, y, unused, unused). */
#include "camera_lib.glsl"
#include <test_value>

void main()
{
  float t_max;
  Ray ray = camera_ray(read_test_value(TEST_INDEX).a.xy, t_max);
  out_origin = vec4(ray.origin, t_max);
  out_direction = vec4(ray.direction, 0.0);
}
