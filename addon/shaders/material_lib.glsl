/* The paper's colour class (3.1.1), each colour a constant, times an image by uv, times an attribute. */
#include "ray_lib.glsl"
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

/* Leave nothing of a material but what it transmits. */
void material_hide(inout Material material)
{
  material.diffuse = vec3(0.0);
  material.reflect = vec3(0.0);
  material.glow = vec3(0.0);
  material.highlight = vec3(0.0);
}
