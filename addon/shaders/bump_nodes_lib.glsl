/* Normals that nodes make: of heights, of colors, and the tangents that they need. */
#include "coordinate_nodes_lib.glsl"

#ifdef HAS_GRADIENTS

#define BUMP_WIDTH 0.1     /* of a pixel: how far beside the point a height is taken, where that is not a whole pixel */
#define BUMP_ROUNDING 1e-4 /* but of the coordinates: below it what float32 rounds away would be seen */

/* How far beside a point heights are taken, a length; `wide`: 1 for a whole pixel. */
float bump_step(Point point, int wide)
{
  float pixel = abs(frame_raster.x) * (frame_orthographic > 0.5 ? 1.0 : point.ray_length);
  vec3 size = abs(point.position);
  return max((wide > 0 ? 1.0 : BUMP_WIDTH) * pixel, BUMP_ROUNDING * max(size.x, max(size.y, size.z)));
}

/* Two unit vectors across a unit vector and each other, right-handed with it. (Duff et al. 2017, Building an Orthonormal
 * Basis, Revisited.) */
void bump_axes(vec3 n, out vec3 first, out vec3 second)
{
  float side = n.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (side + n.z);
  float b = n.x * n.y * a;
  first = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
  second = vec3(b, side + n.y * n.y * a, -n.y);
}

/* The point a step beside another along the surface, in the first (0) or second (1) of `bump_axes`; 2 and 3: the same by a
 * wide step. */
Point point_beside(Point point, int axis)
{
  vec3 first;
  vec3 second;
  bump_axes(point.true_normal, first, second);
  vec3 moved = point.position + bump_step(point, axis / 2) * (axis == 0 || axis == 2 ? first : second);
  vec3 offset = moved - point.position; /* as it is after rounding */
  point.position = moved;
  point.uv += vec2(dot(point.surface.gradient_u, offset), dot(point.surface.gradient_v, offset));
#ifdef HAS_ATTRIBUTES
  point.surface.weights += vec2(dot(point.surface.gradient_first, offset), dot(point.surface.gradient_second, offset));
#endif
  return point;
}

/* The normal of a surface that is raised by `distance` times a height; `beside_0` and `beside_1` are the height there.
 * (Mikkelsen 2010, Bump Mapping Unparametrized Surfaces on the GPU.) */
vec3 bump_normal(Point point, vec3 normal, float height, float beside_0, float beside_1, float strength, float distance,
                 int wide)
{
  vec3 first;
  vec3 second;
  bump_axes(point.true_normal, first, second);
  vec3 across_second = cross(second, normal);
  float area = dot(first, across_second);
  vec3 slope = ((beside_0 - height) * across_second + (beside_1 - height) * cross(normal, first)) / bump_step(point, wide);
  vec3 raised = coordinate_unit(abs(area) * normal - (area < 0.0 ? -distance : distance) * slope);
  strength = max(strength, 0.0);
  return dot(raised, raised) == 0.0 ? normal : coordinate_unit(strength * raised + (1.0 - strength) * normal);
}

/* The direction along the surface in which u grows while v stays, 0 where uv tells none; its length is of no meaning. */
vec3 bump_direction_of_u(Point point)
{
  vec3 along = cross(point.surface.gradient_v, point.true_normal);
  return dot(along, point.surface.gradient_u) < 0.0 ? -along : along;
}

vec3 bump_tangent(Point point)
{
  return coordinate_along(point, bump_direction_of_u(point));
}

/* The normal that a color tells in the axes of u, v and the normal. */
vec3 bump_tangent_map(Point point, vec3 color, float strength)
{
  vec3 tangent = bump_tangent(point);
  if (dot(tangent, tangent) == 0.0) {
    return point.normal;
  }
  vec3 normal = point.backfacing ? -point.normal : point.normal; /* of the surface's outside */
  vec3 other = cross(normal, tangent);
  other *= dot(other, point.surface.gradient_v) < 0.0 ? -1.0 : 1.0;
  vec3 told = 2.0 * color - 1.0;
  told.xy *= strength;
  told.z = mix(1.0, told.z, clamp(strength, 0.0, 1.0));
  vec3 mapped = coordinate_unit(told.x * tangent + told.y * other + told.z * normal);
  if (dot(mapped, mapped) == 0.0) {
    return point.normal;
  }
  return point.backfacing ? -mapped : mapped;
}

#endif

/* The normal `told`, of the surface's outside, mixed with the surface's own. */
vec3 bump_mixed(Point point, vec3 told, float strength)
{
  vec3 normal = point.backfacing ? -told : told;
  normal = coordinate_unit(point.normal + (normal - point.normal) * max(strength, 0.0));
  return dot(normal, normal) == 0.0 ? point.normal : normal;
}
