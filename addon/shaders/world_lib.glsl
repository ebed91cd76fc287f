/* The sky. */
#include "material_lib.glsl"

/* What a ray that hits nothing sees, where the only program is the world's. */
vec3 world_radiance(Ray ray)
{
  Surface none = ray_make_surface(vec3(0.0), -ray.direction, -ray.direction, vec2(0.0), 0, 0.0);
  Material material = read_material(int(frame_world_material));
#ifdef HAS_PROGRAMS
  programs_run(1, int(frame_constant_first) + material.constants, point_of_sky(none, ray, 1), material);
#endif
  return material.glow;
}
