/* Image number a.x at uv a.yz, and of the tiles from number a.x on, a.w of them; projections of the vector b.xyz. */
#include "image_texture_lib.glsl"
#include "panorama_lib.glsl"
#include "projection_nodes_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  out_color = image_sample(int(value.a.x), value.a.yz);
  out_tile = image_sample_tiled(int(value.a.x), int(value.a.w), value.a.yz);
  out_round = vec4(panorama_uv(value.b.xyz), projection_mirror_ball(value.b.xyz));
  out_cube = vec4(projection_sphere(value.b.xyz), projection_tube(value.b.xyz));
  out_box = vec4(projection_box(value.b.xyz, value.b.w), 0.0);
}
