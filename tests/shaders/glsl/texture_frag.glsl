/* Whatever TEST_CALL makes of a place a and of four more numbers b; `color` and `position` are there for its results. */
#include "noise_texture_lib.glsl"
#include "voronoi_texture_lib.glsl"
#include "gabor_texture_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  vec4 a = value.a;
  vec4 b = value.b;
  vec3 color = vec3(0.0);
  vec4 position = vec4(0.0);
  out_value = TEST_CALL;
  out_color = vec4(color, 0.0);
  out_position = position;
}
