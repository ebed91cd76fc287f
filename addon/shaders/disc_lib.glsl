/* The disc: paper 3.1.7 and 3.2.4. */
#include "ray_lib.glsl"
#include <disc>
#include <disc_surface>

/* A disc reaches over its edge by about the rounding of what is compared, since most discs close a cylinder or cone, and
 * what rounds to the outside of both the disc and the side would get in. */
#define DISC_SLACK 1.000004

/* Nearest t in (0, t_max), else t_max. */
float disc_hit(Disc disc, Ray ray, float t_max)
{
  vec3 to_center = disc.center - ray.origin;
  float t = dot(to_center, disc.normal) / dot(ray.direction, disc.normal);
  vec3 offset = t * ray.direction - to_center;
  /* A ray in the plane makes t infinite or not a number, which no comparison lets through. */
  return (t > 0.0 && t < t_max && dot(offset, offset) <= disc.radius * disc.radius * DISC_SLACK) ? t : t_max;
}

Surface disc_surface(Disc disc, DiscSurface info, Ray ray, float t)
{
  vec3 offset = ray.origin - disc.center + t * ray.direction;
  offset -= dot(offset, disc.normal) * disc.normal;
  vec3 other = cross(disc.normal, info.meridian);
  vec2 uv = vec2(dot(offset, info.meridian), dot(offset, other)) / (2.0 * disc.radius) + 0.5;
  Surface surface = ray_make_surface(disc.center + offset, disc.normal, disc.normal, uv * info.uv_transform.xy + info.uv_transform.zw,
                 info.material, ray_flat_error(disc.normal, max(abs(disc.center), abs(disc.center + offset))));
#ifdef HAS_GRADIENTS
  surface.gradient_u = info.uv_transform.x / (2.0 * disc.radius) * info.meridian;
  surface.gradient_v = info.uv_transform.y / (2.0 * disc.radius) * other;
#endif
  return surface;
}
