/* Light number a.x seen from the point b.xyz: from its middle, or with a.w from the point of it that a.yz choose. */
#include "light_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  int index = int(value.a.x);
  Light light = read_light(index);
  vec3 direction;
  float range;
  vec3 radiance = light_shaped_at(light, index, value.b.xyz, value.a.w > 0.5, value.a.yz, direction, range);
  out_radiance = vec4(radiance, range);
  out_direction = vec4(direction, 0.0);
  out_position = vec4(light.position, 0.0);
}
