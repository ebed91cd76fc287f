/* A place in the space of an object and back, a bump's axes, and the point beside one. */
#include "bump_nodes_lib.glsl"
#include <test_value>

void main()
{
  TestValue a = read_test_value(3 * TEST_INDEX);
  TestValue b = read_test_value(3 * TEST_INDEX + 1);
  TestValue c = read_test_value(3 * TEST_INDEX + 2);
  Surface surface = ray_make_surface(c.a.xyz, c.b.xyz, c.b.xyz, vec2(0.25, 0.5), 0, 0.0);
  surface.gradient_u = b.b.xyz;
  surface.gradient_v = a.b.xyz;
  Point point = point_of_surface(surface, ray_make(vec3(0.0), -c.b.xyz, RAY_CAMERA), 2.0, 1);
  Point next = point_beside(point, 0);
  out_place = vec4(coordinate_in_space(point, a.a, a.b, b.a), bump_step(point, 0));
  out_normal = vec4(coordinate_normal_from_space(coordinate_normal_to_space(c.b.xyz, a.a, a.b, b.a), a.a, a.b, b.a), 0.0);
  out_vector = vec4(coordinate_vector_from_space(coordinate_vector_to_space(c.b.xyz, a.a, a.b, b.a), a.a, a.b, b.a), 0.0);
  out_beside = vec4(next.position - point.position, next.uv.x - point.uv.x);
}
