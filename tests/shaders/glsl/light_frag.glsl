/* Light number a.x seen from the point b.xyz. */
#include "light_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  vec3 direction;
  float range;
  vec3 radiance = light_at(read_light(int(value.a.x)), value.b.xyz, direction, range);
  out_radiance = vec4(radiance, range);
  out_direction = vec4(direction, 0.0);
}
