/* Metal i: the cosine of incidence, its index of refraction and its extinction. */
#include "optics_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  out_color = vec4(optics_conductor(value.a.x, value.a.yzw, value.b.xyz), 0.0);
}
