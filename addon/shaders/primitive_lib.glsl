/* The only switch over the kinds of primitives; a scene compiles only the kinds that it holds. */
#include "ray_lib.glsl"
#ifdef HAS_SPHERE
#include "sphere_lib.glsl"
#endif
#ifdef HAS_CYLINDER
#include "cylinder_lib.glsl"
#endif
#ifdef HAS_CONE
#include "cone_lib.glsl"
#endif
#ifdef HAS_DISC
#include "disc_lib.glsl"
#endif
#ifdef HAS_TRIANGLE
#include "triangle_lib.glsl"
#endif
#ifdef HAS_PLANE
#include "plane_lib.glsl"
#endif

struct Hit {
  float t;
  int kind; /* -1: nothing hit */
  int index;
  int instance; /* -1: in world space */
};

#define PRIMITIVE_TEST(KIND, read, test, i) \
  { \
    float t = test(read(i), ray, hit.t); \
    if (t < hit.t) { \
      hit.t = t; \
      hit.kind = KIND; \
      hit.index = i; \
    } \
  }

/* Test the primitives of one leaf and keep the nearest hit. */
void primitive_leaf_hit(int kind, int first, int count, Ray ray, inout Hit hit)
{
  int end = first + count;
#ifdef HAS_SPHERE
  if (kind == KIND_SPHERE) {
    for (int i = first; i < end; i++) PRIMITIVE_TEST(KIND_SPHERE, read_sphere, sphere_hit, i)
  }
#endif
#ifdef HAS_CYLINDER
  if (kind == KIND_CYLINDER) {
    for (int i = first; i < end; i++) PRIMITIVE_TEST(KIND_CYLINDER, read_cylinder, cylinder_hit, i)
  }
#endif
#ifdef HAS_CONE
  if (kind == KIND_CONE) {
    for (int i = first; i < end; i++) PRIMITIVE_TEST(KIND_CONE, read_cone, cone_hit, i)
  }
#endif
#ifdef HAS_DISC
  if (kind == KIND_DISC) {
    for (int i = first; i < end; i++) PRIMITIVE_TEST(KIND_DISC, read_disc, disc_hit, i)
  }
#endif
#ifdef HAS_TRIANGLE
  if (kind == KIND_TRIANGLE) {
    for (int i = first; i < end; i++) PRIMITIVE_TEST(KIND_TRIANGLE, read_triangle, triangle_hit, i)
  }
#endif
}

/* Test the infinite planes, which every ray meets. */
void primitive_planes_hit(int count, Ray ray, inout Hit hit)
{
#ifdef HAS_PLANE
  for (int i = 0; i < count; i++) {
    if (!ray_sees(ray, read_plane(i).visibility)) {
      continue;
    }
    PRIMITIVE_TEST(KIND_PLANE, read_plane, plane_hit, i)
  }
#endif
}

bool primitive_is_flat(int kind)
{
  return kind == KIND_TRIANGLE || kind == KIND_DISC || kind == KIND_PLANE;
}

/* The surface at a hit, in the space of the ray that made it. */
Surface primitive_surface(Hit hit, Ray ray)
{
#ifdef HAS_SPHERE
  if (hit.kind == KIND_SPHERE) {
    return sphere_surface(read_sphere(hit.index), read_sphere_surface(hit.index), ray, hit.t);
  }
#endif
#ifdef HAS_CYLINDER
  if (hit.kind == KIND_CYLINDER) {
    return cylinder_surface(read_cylinder(hit.index), read_cylinder_surface(hit.index), ray, hit.t);
  }
#endif
#ifdef HAS_CONE
  if (hit.kind == KIND_CONE) {
    return cone_surface(read_cone(hit.index), read_cone_surface(hit.index), ray, hit.t);
  }
#endif
#ifdef HAS_DISC
  if (hit.kind == KIND_DISC) {
    return disc_surface(read_disc(hit.index), read_disc_surface(hit.index), ray, hit.t);
  }
#endif
#ifdef HAS_TRIANGLE
  if (hit.kind == KIND_TRIANGLE) {
    return triangle_surface(read_triangle(hit.index), read_triangle_surface(hit.index), ray, hit.t);
  }
#endif
#ifdef HAS_PLANE
  if (hit.kind == KIND_PLANE) {
    return plane_surface(read_plane(hit.index), read_plane_surface(hit.index), ray, hit.t);
  }
#endif
  return ray_make_surface(ray.origin, -ray.direction, -ray.direction, vec2(0.0), 0, 0.0);
}
