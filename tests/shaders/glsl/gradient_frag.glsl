/* Ray i against primitive i: the gradients of uv and of the weights where it hits. */
#include "primitive_lib.glsl"
#include <test_ray>

void main()
{
  TestRay test = read_test_ray(TEST_INDEX);
  Ray ray = ray_make(test.origin, test.direction, test.kind);
  float t = TEST_HIT(TEST_READ(TEST_INDEX), ray, test.t_max);
  Surface surface = TEST_SURFACE(TEST_READ(TEST_INDEX), TEST_READ_SURFACE(TEST_INDEX), ray, t);
  out_position = vec4(surface.position, t);
  out_u = vec4(surface.gradient_u, surface.weights.x);
  out_v = vec4(surface.gradient_v, surface.weights.y);
  out_first = vec4(surface.gradient_first, 0.0);
  out_second = vec4(surface.gradient_second, 0.0);
}
