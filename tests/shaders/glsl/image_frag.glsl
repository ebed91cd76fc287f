/* Image number a.x at uv a.yz; the uv of the sky towards b.xyz. */
#include "image_lib.glsl"
#include "world_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  out_color = image_sample(int(value.a.x), value.a.yz);
  out_sky = vec4(world_uv(value.b.xyz), 0.0, 0.0);
  out_radiance = vec4(world_radiance(value.b.xyz), 0.0);
}
