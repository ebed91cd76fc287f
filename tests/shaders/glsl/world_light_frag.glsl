/* A direction towards the world chosen by a.xy for the normal b.xyz, of whose light b.w comes from behind, the brightness of
 * the map there, the light of the hemisphere above the normal, and a direction that goes over the map and back. */
#include "world_light_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  float scale;
  vec3 direction = world_light_direction(value.b.xyz, value.b.w, value.a.xy, scale);
  out_direction = vec4(direction, scale);
  out_bright = vec4(world_light_bright_direction(value.a.xy), world_light_brightness(direction));
  out_hemisphere = vec4(world_light_hemisphere(value.b.xyz), 0.0);
  out_mapped = vec4(octahedron_direction(octahedron_uv(value.b.xyz)), 0.0);
}
