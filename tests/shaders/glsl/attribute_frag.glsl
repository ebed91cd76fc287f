/* Ray i against the whole scene: attributes 0 and 1 of what it hits, and which primitive that is. */
#include "bvh_lib.glsl"
#include "attribute_texture_lib.glsl"
#include <material>
#include <test_ray>

void main()
{
  TestRay test = read_test_ray(TEST_INDEX);
  Ray ray = ray_make(test.origin, test.direction, test.kind);
  Hit hit = bvh_traverse(ray, test.t_max, false);
  out_first = vec4(0.0);
  out_second = vec4(0.0);
  out_hit = vec4(-1.0);
  if (hit.kind >= 0) {
    Surface surface = bvh_surface(hit, ray);
    Point point = point_of_surface(surface, ray, hit.t, 1);
    out_first = attribute_value(point, 0);
    out_second = attribute_value(point, 1);
    out_hit = vec4(read_material(surface.material).glow.x, surface.position);
  }
}
