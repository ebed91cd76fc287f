/* Sample a.z of dimension a.w in the pixel a.xy. */
#include "sampling_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  out_color = vec4(sampling_2d(sampling_pixel(value.a.xy), int(value.a.z), int(value.a.w)), 0.0, 0.0);
}
