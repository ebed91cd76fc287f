/* A sample of each cell of the map of the world's light. */
#include "octahedron_lib.glsl"
#include "world_lib.glsl"

void main()
{
  vec3 direction = octahedron_direction(PIXEL * frame_raster.xy + frame_raster.zw);
  out_color = vec4(world_radiance(ray_make(vec3(0.0), direction, RAY_DIFFUSE)), 1.0);
}
