/* A walk through bodies: a and b are eight steps; m + 1 enters material m, -(m + 1) leaves it, 0 does nothing. */
#include "medium_lib.glsl"
#include <test_value>

ivec4 step(ivec4 media, float what)
{
  int material = int(abs(what)) - 1;
  if (what == 0.0) {
    return media;
  }
  return what > 0.0 ? medium_enter(media, material) : medium_leave(media, material);
}

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  ivec4 media = medium_outside();
  for (int i = 0; i < 4; i++) {
    media = step(media, value.a[i]);
  }
  for (int i = 0; i < 4; i++) {
    media = step(media, value.b[i]);
  }
  out_media = vec4(media);
  out_inside = vec4(medium_absorption(media), medium_ior(media));
}
