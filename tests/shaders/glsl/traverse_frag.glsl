/* Ray i against the whole scene: nearest and any hit, and the surface of the nearest. */
#include "bvh_lib.glsl"
#include <material>
#include <test_ray>

void main()
{
  TestRay test = read_test_ray(TEST_INDEX);
  Ray ray = ray_make(test.origin, test.direction, test.kind);
  Hit hit = bvh_traverse(ray, test.t_max, false);
  Hit any = bvh_traverse(ray, test.t_max, true);
  out_hit = vec4(hit.t, float(hit.kind), float(hit.instance), float(any.kind));
  Surface surface = ray_make_surface(vec3(0.0), vec3(0.0), vec3(0.0), vec2(0.0), -1, 0.0);
  vec3 spawned = vec3(0.0);
  float number = -1.0; /* materials glow with their number */
  if (hit.kind >= 0) {
    surface = bvh_surface(hit, ray);
    number = read_material(surface.material).glow.x;
    spawned = ray_spawn(surface, test.next);
  }
  out_position = vec4(surface.position, surface.error);
  out_normal = vec4(surface.geometric_normal, number);
  out_spawned = vec4(spawned, any.t);
}
