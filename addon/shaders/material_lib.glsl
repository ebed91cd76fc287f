/* The paper's colour class (3.1.1), each colour a constant or an image by uv. */
#include <material>
#ifdef HAS_IMAGES
#include "image_lib.glsl"
#endif

vec3 material_textured(vec3 color, int image, vec2 uv)
{
#ifdef HAS_IMAGES
  if (image >= 0) {
    return color * image_sample(image, uv).rgb;
  }
#endif
  return color;
}

/* The material with its images evaluated at uv. */
Material material_at(int index, vec2 uv)
{
  Material material = read_material(index);
  material.diffuse = material_textured(material.diffuse, material.diffuse_image, uv);
  material.reflect = material_textured(material.reflect, material.reflect_image, uv);
  material.transmit = material_textured(material.transmit, material.transmit_image, uv);
  material.glow = material_textured(material.glow, material.glow_image, uv);
  return material;
}
