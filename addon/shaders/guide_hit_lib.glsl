/* The guide of what the eye ray meets. */
#include "guide_lib.glsl"
#include "primitive_lib.glsl"
#include "point_lib.glsl"
#ifdef OUTLINE_ATTRIBUTES
#include "attribute_texture_lib.glsl"
#endif

/* A whole number from 1 to 2^24 - 1, which float32 holds. Two neighbours in the picture have the same one in a case of 16
 * million, when there is one line too few. (Multipliers of xxHash.) */
float guide_hit_number(int kind, int index, int instance)
{
  uint h = uint(index) * 0x9E3779B1u ^ uint(instance + 1) * 0x85EBCA77u ^ uint(kind + 1) * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return float((h ^ (h >> 15)) % 16777215u + 1u);
}

/* The number of the group of a place on a surface. A triangle has one, whatever is between its vertices' values. */
float guide_hit_group(Point point)
{
#ifdef OUTLINE_ATTRIBUTES
  point.surface.weights = vec2(0.0);
  return attribute_value(point, int(frame_outline_attribute)).x;
#else
  return 0.0;
#endif
}

vec4 guide_hit_make(Hit hit, Point point)
{
  bool is_mesh = hit.kind == KIND_TRIANGLE;
  float number = guide_hit_number(hit.kind, is_mesh ? 0 : hit.index, hit.instance);
  float depth = dot(point.position - frame_camera_origin, frame_camera_forward);
  return vec4(depth, guide_packed_normal(point.normal), is_mesh ? -number : number, guide_hit_group(point));
}
