/* The sphere: paper 3.1.6 and 3.2.3. */
#include "ray_lib.glsl"
#include "quadric_lib.glsl"
#include <sphere>
#include <sphere_surface>

/* Nearest t in (0, t_max), else t_max. A negative radius is hit from within only. The distance of the centre from the ray,
 * (23), is taken before squares are subtracted, which keeps small far spheres round (Haines et al., Ray Tracing Gems,
 * chapter 7); the roots' product decides on the sign of the one near 0. */
float sphere_hit(Sphere sphere, Ray ray, float t_max)
{
  vec3 to_center = sphere.center - ray.origin;
  float along = dot(to_center, ray.direction);
  vec3 across = to_center - along * ray.direction;
  float squared = sphere.radius * sphere.radius - dot(across, across);
  if (squared < 0.0) {
    return t_max;
  }
  float s = sqrt(squared);
  float q = along < 0.0 ? along - s : along + s;
  float other = (dot(to_center, to_center) - sphere.radius * sphere.radius) / q;
  float t_near = min(q, other);
  float t_far = max(q, other);
  float t = (t_near > 0.0 && sphere.radius > 0.0) ? t_near : t_far;
  return (t > 0.0 && t < t_max) ? t : t_max;
}

#define SPHERE_FIXED_UV 2.0 /* `rotation.z` is larger where the other two are the uv of the whole sphere */

#define SPHERE_POLE 1e-6 /* distance from the axis, over the radius, nearer to which u turns no faster */

/* Rotate by modified Rodrigues parameters p = axis tan(angle / 4) (Shuster 1993, A survey of attitude representations). */
vec3 sphere_rotate(vec3 p, vec3 v)
{
  float s = dot(p, p);
  float k = 1.0 / ((1.0 + s) * (1.0 + s));
  return v + k * (4.0 * (1.0 - s) * cross(p, v) + 8.0 * cross(p, cross(p, v)));
}

Surface sphere_surface(Sphere sphere, SphereSurface info, Ray ray, float t)
{
  float radius = abs(sphere.radius);
  vec3 normal = normalize(ray.origin + t * ray.direction - sphere.center);
  vec3 local = sphere_rotate(-info.rotation, normal);
  /* atan keeps the digits near the poles that acos, (31), loses. */
  float v = 1.0 - atan(length(local.xy), local.z) * (2.0 / TWO_PI);
  vec2 uv = info.rotation.z > SPHERE_FIXED_UV ? info.rotation.xy : vec2(quadric_u(local.x, local.y), v);
  Surface surface =
      ray_make_surface(sphere.center + radius * normal, normal, normal, uv, info.material, ray_error(sphere.center, radius));
#ifdef HAS_GRADIENTS
  if (info.rotation.z <= SPHERE_FIXED_UV) {
    float per_turn = 1.0 / (TWO_PI * radius * max(length(local.xy), SPHERE_POLE));
    vec2 east = vec2(-local.y, local.x) / max(length(local.xy), SPHERE_POLE);
    surface.gradient_u = per_turn * sphere_rotate(info.rotation, vec3(east, 0.0));
    surface.gradient_v = 2.0 * per_turn * sphere_rotate(info.rotation, vec3(0.0, 0.0, 1.0) - local.z * local);
  }
#endif
  return surface;
}
