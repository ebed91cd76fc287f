/* The paper's colour class (3.1.1), where it varies as its program says. */
#include "point_lib.glsl"
#include "optics_lib.glsl"
#include <material>
#ifdef HAS_PROGRAMS
#include <constant>
#include "programs_lib.glsl"
#endif

/* The material of a number as it is at a point. */
Material material_at(int index, Point point)
{
  Material material = read_material(index);
#ifdef HAS_PROGRAMS
  programs_run(material.program, int(frame_constant_first) + material.constants, point, material);
#endif
  return material;
}

/* The share that is mirrored at a cosine of incidence, where the surface has the reflectance `fresnel`. */
vec3 material_mirror(Material material, float cosine, float fresnel)
{
  vec3 share = material.reflect * (material.fresnel > 0.5 ? fresnel : 1.0);
#ifdef HAS_METALS
  share += optics_metal(material.metallic, material.grazing, material.edge, cosine);
#endif
  return share;
}

/* The index before the mirror's surface over the one beyond, where `eta` is that of what goes through. */
float material_mirror_eta(Material material, float eta)
{
  return material.fresnel_ior > 0.0 ? 1.0 / material.fresnel_ior : eta;
}

/* The share that goes through, where the body's surface has the reflectance `fresnel`. */
vec3 material_through(Material material, float fresnel)
{
  return material.transmit * (1.0 - fresnel * material.transmit_covered);
}

/* Leave nothing of a material but what it transmits. */
void material_hide(inout Material material)
{
  material.diffuse = vec3(0.0);
  material.reflect = vec3(0.0);
  material.glow = vec3(0.0);
  material.highlight = vec3(0.0);
  material.metallic = vec3(0.0);
  material.grazing = vec3(0.0);
  material.coat = vec3(0.0);
  material.translucent = vec3(0.0);
}
