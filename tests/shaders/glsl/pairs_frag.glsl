/* Ray i against primitive i: the hit, its surface, and the same primitive against the ray that leaves the surface. */
#include "primitive_lib.glsl"
#include <test_ray>

void main()
{
  TestRay test = read_test_ray(TEST_INDEX);
  Ray ray = ray_make(test.origin, test.direction, test.kind);
  float t = TEST_HIT(TEST_READ(TEST_INDEX), ray, test.t_max);
  Surface surface = TEST_SURFACE(TEST_READ(TEST_INDEX), TEST_READ_SURFACE(TEST_INDEX), ray, t);
  vec3 spawned = ray_spawn(surface, test.next);
  float t_next = TEST_HIT(TEST_READ(TEST_INDEX), ray_make(spawned, test.next, test.kind), 1e30);
  out_hit = vec4(t, surface.error, float(surface.material), 0.0);
  out_position = vec4(surface.position, surface.uv.x);
  out_normal = vec4(surface.geometric_normal, surface.uv.y);
  out_shading = vec4(surface.shading_normal, 0.0);
  out_spawned = vec4(spawned, t_next);
}
