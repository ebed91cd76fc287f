/* The paper's colour class (3.1.1), each colour a constant, times an image by uv, times an attribute. */
#include "ray_lib.glsl"
#include "optics_lib.glsl"
#include <material>
#ifdef HAS_IMAGES
#include "image_lib.glsl"
#endif
#ifdef HAS_ATTRIBUTES
#include "attribute_lib.glsl"
#endif

vec3 material_textured(vec3 color, int image, int number, Surface surface)
{
#ifdef HAS_IMAGES
  if (image >= 0) {
    color *= image_sample(image, surface.uv).rgb;
  }
#endif
#ifdef HAS_ATTRIBUTES
  if (number >= 0) {
    color *= attribute_value(number, surface).rgb;
  }
#endif
  return color;
}

/* The material of a surface with its images and attributes evaluated there. */
Material material_at(Surface surface)
{
  Material material = read_material(surface.material);
  material.diffuse = material_textured(material.diffuse, material.diffuse_image, material.diffuse_attribute, surface);
  material.reflect = material_textured(material.reflect, material.reflect_image, material.reflect_attribute, surface);
  material.transmit = material_textured(material.transmit, material.transmit_image, material.transmit_attribute, surface);
  material.glow = material_textured(material.glow, material.glow_image, material.glow_attribute, surface);
  return material;
}

/* The share that is mirrored at a cosine of incidence, where a smooth dielectric has the reflectance `fresnel`. */
vec3 material_mirror(Material material, float cosine, float fresnel)
{
  if (material.fresnel > 0.5) {
    return material.reflect * fresnel;
  }
#ifdef HAS_METALS
  return optics_metal(material.reflect, material.grazing, material.edge, cosine);
#else
  return material.reflect;
#endif
}

/* The share that goes through there. */
vec3 material_through(Material material, float fresnel)
{
  return material.transmit * (material.fresnel > 0.5 ? 1.0 - fresnel : 1.0);
}

/* Leave nothing of a material but what it transmits. */
void material_hide(inout Material material)
{
  material.diffuse = vec3(0.0);
  material.reflect = vec3(0.0);
  material.glow = vec3(0.0);
  material.highlight = vec3(0.0);
  material.grazing = vec3(0.0);
}
