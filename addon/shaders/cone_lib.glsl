/* The side of a cone, truncated or not: paper 3.1.9 and 3.2.6, with the square that (40) lacks.
 *
 * The radius grows linearly with the height z above the base, R(z) = r0 + k z. Then |position x axis|^2 = R(z)^2 holds the
 * paper's cone (r0 = 0) without a tip that would lie far away for a nearly cylindrical one; between the ends R never changes
 * its sign, so the mirrored nappe is never met. */
#include "ray_lib.glsl"
#include "quadric_lib.glsl"
#include <cone>
#include <cone_surface>

/* Nearest t in (0, t_max), else t_max. Negative radii are hit from within only.
 *
 * Along the ray the side is a t^2 + 2 b t + c = 0, measured from the ray's point closest to the middle of the cone, so that
 * the digits left are those of the cone's size. The discriminant b^2 - a c loses them again; it equals
 * |R d - k dz p|^2 - |p x d|^2, p and d across the axis, where both lengths keep theirs. A ray steeper than the side
 * (a < 0) meets the double cone always, whatever rounding says near the tip. */
float cone_hit(Cone cone, Ray ray, float t_max)
{
  float height = length(cone.axis);
  vec3 axis = cone.axis / height;
  float slope = (abs(cone.apex_radius) - abs(cone.base_radius)) / height;
  vec3 from_middle = (ray.origin - cone.base) - 0.5 * cone.axis;
  float closest = -dot(from_middle, ray.direction);
  vec3 offset = from_middle + closest * ray.direction + 0.5 * cone.axis;
  float z = dot(offset, axis);
  float dz = dot(ray.direction, axis);
  vec3 position = offset - z * axis;
  vec3 direction = ray.direction - dz * axis;
  float radius = abs(cone.base_radius) + slope * z;
  float growth = slope * dz;
  float a = dot(direction, direction) - growth * growth;
  float to_edge = length(radius * direction - growth * position);
  float to_ray = length(cross(position, direction));
  float discriminant = (to_edge - to_ray) * (to_edge + to_ray);
  if (discriminant < 0.0 && a >= 0.0) {
    return t_max;
  }
  float b = dot(position, direction) - growth * radius;
  float distance_to_axis = length(position);
  float c = (distance_to_axis - radius) * (distance_to_axis + radius);
  vec2 roots = quadric_roots(a, b, c, max(discriminant, 0.0));
  vec2 heights = vec2(z) + roots * dz;
  roots += closest;
  bool outside_seen = cone.base_radius + cone.apex_radius > 0.0;
  bool enters = outside_seen && roots.x > 0.0 && heights.x >= 0.0 && heights.x <= height;
  bool leaves = roots.y > 0.0 && heights.y >= 0.0 && heights.y <= height;
  return min(t_max, min(enters ? roots.x : t_max, leaves ? roots.y : t_max));
}

Surface cone_surface(Cone cone, ConeSurface info, Ray ray, float t)
{
  float base_radius = abs(cone.base_radius);
  float apex_radius = abs(cone.apex_radius);
  float height = length(cone.axis);
  vec3 axis = cone.axis / height;
  float slope = (apex_radius - base_radius) / height;
  vec3 offset = ray.origin - cone.base + t * ray.direction;
  float z = clamp(dot(offset, axis), 0.0, height);
  vec3 across = offset - dot(offset, axis) * axis;
  float distance_to_axis = length(across);
  vec3 radial = distance_to_axis > 0.0 ? across / distance_to_axis : info.meridian; /* at the tip any will do */
  vec3 normal = normalize(radial - slope * axis);
  vec3 other = cross(axis, info.meridian);
  vec2 flat_uv = vec2(dot(across, info.meridian), dot(across, other)) / (2.0 * max(base_radius, apex_radius)) + 0.5;
  vec2 round_uv = vec2(quadric_u(dot(radial, info.meridian), dot(radial, other)), z / height);
  vec2 uv = info.planar > 0.5 ? flat_uv : round_uv;
  return Surface(cone.base + z * axis + (base_radius + slope * z) * radial, normal, normal,
                 uv * info.uv_transform.xy + info.uv_transform.zw, info.material,
                 ray_error(cone.base, height + max(base_radius, apex_radius)));
}
