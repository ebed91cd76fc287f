/* The side of a cylinder: paper 3.1.8 and 3.2.5, with the square that (34) lacks. */
#include "ray_lib.glsl"
#include "quadric_lib.glsl"
#include <cylinder>
#include <cylinder_surface>

/* Nearest t in (0, t_max), else t_max. A negative radius is hit from within only. */
float cylinder_hit(Cylinder cylinder, Ray ray, float t_max)
{
  float radius = abs(cylinder.radius);
  return quadric_hit(cylinder.base, cylinder.axis, radius, radius, cylinder.radius > 0.0, ray, t_max);
}

Surface cylinder_surface(Cylinder cylinder, CylinderSurface info, Ray ray, float t)
{
  float radius = abs(cylinder.radius);
  float height = length(cylinder.axis);
  vec3 axis = cylinder.axis / height;
  vec3 offset = ray.origin - cylinder.base + t * ray.direction;
  float z = clamp(dot(offset, axis), 0.0, height);
  vec3 normal = normalize(offset - dot(offset, axis) * axis);
  vec2 uv = vec2(quadric_u(dot(normal, info.meridian), dot(normal, cross(axis, info.meridian))), z / height);
  Surface surface = ray_make_surface(cylinder.base + z * axis + radius * normal, normal, normal,
                 uv * info.uv_transform.xy + info.uv_transform.zw, info.material,
                 ray_error(cylinder.base, height + radius));
#ifdef HAS_GRADIENTS
  surface.gradient_u = info.uv_transform.x / (TWO_PI * radius) * cross(axis, normal);
  surface.gradient_v = info.uv_transform.y / height * axis;
#endif
#ifdef HAS_ATTRIBUTES
  surface.weights.x = z / height; /* of the apex */
#ifdef HAS_GRADIENTS
  surface.gradient_first = axis / height;
#endif
#endif
  return surface;
}
