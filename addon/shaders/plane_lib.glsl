/* The infinite plane: paper 3.1.4 and 3.2.1. */
#include "ray_lib.glsl"
#include <plane>
#include <plane_surface>

/* Nearest t in (0, t_max), else t_max. */
float plane_hit(Plane plane, Ray ray, float t_max)
{
  float t = -(dot(ray.origin, plane.normal) + plane.offset) / dot(ray.direction, plane.normal);
  return (t > 0.0 && t < t_max) ? t : t_max;
}

Surface plane_surface(Plane plane, PlaneSurface info, Ray ray, float t)
{
  vec3 position = ray.origin + t * ray.direction;
  position -= (dot(position, plane.normal) + plane.offset) * plane.normal;
  vec3 offset = position - info.origin;
  vec3 other = cross(plane.normal, info.meridian);
  vec2 uv = vec2(dot(offset, info.meridian), dot(offset, other));
  Surface surface = ray_make_surface(position, plane.normal, plane.normal, uv, info.material,
                 ray_flat_error(plane.normal, position) + RAY_RELATIVE_ERROR * abs(plane.offset));
#ifdef HAS_GRADIENTS
  surface.gradient_u = info.meridian;
  surface.gradient_v = other;
#endif
  return surface;
}
