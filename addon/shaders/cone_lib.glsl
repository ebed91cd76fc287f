/* The side of a cone, truncated or not: paper 3.1.9 and 3.2.6, with the square that (40) lacks. The radius grows linearly
 * from base to apex. */
#include "ray_lib.glsl"
#include "quadric_lib.glsl"
#include <cone>
#include <cone_surface>

#define CONE_TIP 1e-6 /* radius, over the largest, below which u turns no faster */

/* Nearest t in (0, t_max), else t_max. Negative radii are hit from within only. */
float cone_hit(Cone cone, Ray ray, float t_max)
{
  bool outside_seen = cone.base_radius + cone.apex_radius > 0.0;
  return quadric_hit(cone.base, cone.axis, abs(cone.base_radius), abs(cone.apex_radius), outside_seen, ray, t_max);
}

Surface cone_surface(Cone cone, ConeSurface info, Ray ray, float t)
{
  float base_radius = abs(cone.base_radius);
  float apex_radius = abs(cone.apex_radius);
  float height = length(cone.axis);
  vec3 axis = cone.axis / height;
  float slope = (apex_radius - base_radius) / height;
  vec3 offset = ray.origin - cone.base + t * ray.direction;
  vec3 across = offset - dot(offset, axis) * axis;
  float distance_to_axis = length(across);
  /* Height of the nearest point of the side: a flat cone's radius changes much with little height. */
  float nearest = (dot(offset, axis) + slope * (distance_to_axis - base_radius)) / (1.0 + slope * slope);
  float z = clamp(nearest, 0.0, height);
  vec3 radial = distance_to_axis > 0.0 ? across / distance_to_axis : info.meridian; /* at the tip any will do */
  vec3 normal = normalize(radial - slope * axis);
  vec3 other = cross(axis, info.meridian);
  vec2 flat_uv = vec2(dot(across, info.meridian), dot(across, other)) / (2.0 * max(base_radius, apex_radius)) + 0.5;
  vec2 round_uv = vec2(quadric_u(dot(radial, info.meridian), dot(radial, other)), z / height);
  vec2 uv = info.planar > 0.5 ? flat_uv : round_uv;
  Surface surface = ray_make_surface(cone.base + z * axis + (base_radius + slope * z) * radial, normal, normal,
                 uv * info.uv_transform.xy + info.uv_transform.zw, info.material,
                 ray_error(cone.base, height + max(base_radius, apex_radius)));
#ifdef HAS_GRADIENTS
  bool is_planar = info.planar > 0.5;
  float width = 2.0 * max(base_radius, apex_radius);
  float turn = TWO_PI * max(base_radius + slope * z, CONE_TIP * width);
  surface.gradient_u = info.uv_transform.x * (is_planar ? info.meridian / width : cross(axis, radial) / turn);
  surface.gradient_v = info.uv_transform.y * (is_planar ? other / width : axis / height);
#endif
#ifdef HAS_ATTRIBUTES
  surface.weights.x = z / height; /* of the apex */
#ifdef HAS_GRADIENTS
  surface.gradient_first = axis / height;
#endif
#endif
  return surface;
}
