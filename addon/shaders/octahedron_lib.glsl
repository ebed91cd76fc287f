/* All directions on a square, equal areas for equal solid angles: an octahedron's eight sides unfolded, the upper four about
 * the middle (Clarberg 2008, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD). */
#include "quadric_lib.glsl"

/* The unit direction at a place of the square from (0, 0) to (1, 1). */
vec3 octahedron_direction(vec2 uv)
{
  vec2 place = 2.0 * uv - 1.0;
  vec2 size = abs(place);
  float inside = 1.0 - size.x - size.y; /* of the diamond that is the upper half */
  float radius = 1.0 - abs(inside);
  float angle = TWO_PI / 8.0 * (radius > 0.0 ? 1.0 + (size.y - size.x) / radius : 1.0);
  vec2 across = radius * sqrt(max(2.0 - radius * radius, 0.0)) * vec2(cos(angle), sin(angle));
  float height = 1.0 - radius * radius;
  return vec3(place.x < 0.0 ? -across.x : across.x, place.y < 0.0 ? -across.y : across.y, inside < 0.0 ? -height : height);
}

/* The place of a unit direction. */
vec2 octahedron_uv(vec3 direction)
{
  vec2 size = abs(direction.xy);
  float radius = sqrt(dot(size, size) / (1.0 + abs(direction.z)));
  float y = size.x + size.y > 0.0 ? radius * atan(size.y, size.x) * (4.0 / TWO_PI) : 0.0;
  float x = radius - y;
  vec2 place = direction.z < 0.0 ? vec2(1.0 - y, 1.0 - x) : vec2(x, y);
  return 0.5 + 0.5 * vec2(direction.x < 0.0 ? -place.x : place.x, direction.y < 0.0 ? -place.y : place.y);
}
