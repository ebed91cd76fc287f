/* The side of a cone, truncated or not: paper 3.1.9 and 3.2.6, with the square that (40) lacks.
 *
 * The radius grows linearly with the height z above the base, R(z) = r0 + k z. Then |position x axis|^2 = R(z)^2 holds the
 * paper's cone (r0 = 0) without a tip that would lie far away for a nearly cylindrical one; between the ends R never changes
 * its sign, so the mirrored nappe is never met. */
#include "ray_lib.glsl"
#include "quadric_lib.glsl"
#include <cone>
#include <cone_surface>

/* b^2 - a c, from the point of the ray closest to the middle of the cone: the value does not depend on the point, but its
 * rounding error does. */
float cone_discriminant(Cone cone, vec3 axis, float slope, Ray ray, vec3 direction, float dz, float a)
{
  vec3 middle = cone.base + 0.5 * cone.axis;
  vec3 offset = ray.origin - middle;
  offset += dot(middle - ray.origin, ray.direction) * ray.direction;
  offset += 0.5 * cone.axis;
  float z = dot(offset, axis);
  vec3 position = offset - z * axis;
  float radius = abs(cone.base_radius) + slope * z;
  float b = dot(position, direction) - slope * dz * radius;
  float c = dot(position, position) - radius * radius;
  return b * b - a * c;
}

/* Nearest t in (0, t_max), else t_max. Negative radii are hit from within only. */
float cone_hit(Cone cone, Ray ray, float t_max)
{
  float height = length(cone.axis);
  vec3 axis = cone.axis / height;
  float slope = (abs(cone.apex_radius) - abs(cone.base_radius)) / height;
  vec3 offset = ray.origin - cone.base;
  float z = dot(offset, axis);
  float dz = dot(ray.direction, axis);
  vec3 position = offset - z * axis;
  vec3 direction = ray.direction - dz * axis;
  float radius = abs(cone.base_radius) + slope * z;
  float a = dot(direction, direction) - slope * dz * slope * dz;
  float discriminant = cone_discriminant(cone, axis, slope, ray, direction, dz, a);
  if (discriminant < 0.0) {
    return t_max;
  }
  float b = dot(position, direction) - slope * dz * radius;
  float distance_to_axis = length(position);
  float c = (distance_to_axis - radius) * (distance_to_axis + radius);
  vec2 roots = quadric_roots(a, b, c, discriminant);
  vec2 heights = vec2(z) + roots * dz;
  bool outside_seen = cone.base_radius + cone.apex_radius > 0.0;
  /* The outside is seen where the ray goes against the gradient: a t + b < 0. */
  if (roots.x > 0.0 && heights.x >= 0.0 && heights.x <= height && (outside_seen || a * roots.x + b >= 0.0)) {
    return min(roots.x, t_max);
  }
  if (roots.y > 0.0 && heights.y >= 0.0 && heights.y <= height && (outside_seen || a * roots.y + b >= 0.0)) {
    return min(roots.y, t_max);
  }
  return t_max;
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
