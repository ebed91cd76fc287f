/* The bodies that a ray is inside of, innermost first, as material indices: nested glass, drinks and bubbles need the index
 * and absorption of what lies around a body when the ray leaves it. Deeper than four is forgotten outermost first. */
#include <material>

#define MEDIUM_NONE (-1)

ivec4 medium_outside()
{
  return ivec4(MEDIUM_NONE);
}

ivec4 medium_enter(ivec4 media, int material)
{
  return ivec4(material, media.xyz);
}

/* Without the innermost mention of this material; bodies that overlap may be left in any order. A body may be entered by one
 * of its materials and left by another, a bottle by its label: what is not mentioned leaves the innermost body. */
ivec4 medium_leave(ivec4 media, int material)
{
  if (media.x != material) {
    if (media.y == material) {
      return ivec4(media.x, media.zw, MEDIUM_NONE);
    }
    if (media.z == material) {
      return ivec4(media.xy, media.w, MEDIUM_NONE);
    }
    if (media.w == material) {
      return ivec4(media.xyz, MEDIUM_NONE);
    }
  }
  return ivec4(media.yzw, MEDIUM_NONE);
}

float medium_ior(ivec4 media)
{
  return media.x == MEDIUM_NONE ? 1.0 : read_material(media.x).ior;
}

vec3 medium_absorption(ivec4 media)
{
  return media.x == MEDIUM_NONE ? vec3(0.0) : read_material(media.x).absorption;
}
