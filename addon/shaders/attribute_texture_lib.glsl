/* Values that a geometry's primitives, or the instances, carry by name: see `layout.ATTRIBUTE` for the directory. */
#include "point_lib.glsl"
#include <attribute>

Attribute attribute_entry(int number, int geometry, int kind)
{
  return read_attribute((number * (int(frame_geometry_count) + 1) + geometry) * KIND_COUNT + kind);
}

/* The value of one primitive or instance, between its two or three values by their weights. Differences are weighted, so
 * that where the values are equal exactly that comes out. */
vec4 attribute_blended(Attribute entry, int index, vec2 weights)
{
  int texel = JOIN_INDEX(entry.first, entry.first_high) + (index - JOIN_INDEX(entry.base, entry.base_high)) * entry.width;
  vec4 first = fetch_attributes(texel);
  vec4 value = first;
  if (entry.width > 1) {
    value += weights.x * (fetch_attributes(texel + 1) - first);
  }
  if (entry.width > 2) {
    value += weights.y * (fetch_attributes(texel + 2) - first);
  }
  return value;
}

/* Of the primitive if its geometry has the attribute, else of the instance, else 0. */
vec4 attribute_value(Point point, int number)
{
  Surface surface = point.surface;
  Attribute entry = attribute_entry(number, surface.geometry, surface.kind);
  if (entry.width > 0) {
    return attribute_blended(entry, surface.index, surface.weights);
  }
  entry = attribute_entry(number, int(frame_geometry_count), KIND_INSTANCE);
  if (entry.width > 0 && surface.instance >= 0) {
    return attribute_blended(entry, surface.instance, vec2(0.0));
  }
  return vec4(0.0);
}
