/* A function of values, in TEST_CALL, of the eight numbers of `a` and `b`. */
#include "math_lib.glsl"
#include "color_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  vec4 a = value.a;
  vec4 b = value.b;
  out_color = vec4(0.0);
  TEST_CALL;
}
