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
#ifdef HAS_QUADRIC_LEAVES
#include "quadric_lib.glsl"
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

#define PRIMITIVE_TESTS(KIND, read, test, first, count) \
  for (int i = first; i < first + count; i++) PRIMITIVE_TEST(KIND, read, test, i)

#ifdef HAS_QUADRIC_LEAVES
/* Test a cylinder, a cone or a sphere: a cylinder without a length. */
void primitive_quadric_hit(int kind, int index, Ray ray, inout Hit hit)
{
  vec3 base = vec3(0.0);
  vec3 axis = vec3(0.0);
  float base_radius = 1.0;
  float apex_radius = 1.0;
#ifdef HAS_SPHERE_LEAVES
  if (kind == KIND_SPHERE) {
    Sphere sphere = read_sphere(index);
    base = sphere.center;
    base_radius = sphere.radius;
    apex_radius = sphere.radius;
  }
#endif
#ifdef HAS_CYLINDER_LEAVES
  if (kind == KIND_CYLINDER) {
    Cylinder cylinder = read_cylinder(index);
    base = cylinder.base;
    axis = cylinder.axis;
    base_radius = cylinder.radius;
    apex_radius = cylinder.radius;
  }
#endif
#ifdef HAS_CONE_LEAVES
  if (kind == KIND_CONE) {
    Cone cone = read_cone(index);
    base = cone.base;
    axis = cone.axis;
    base_radius = cone.base_radius;
    apex_radius = cone.apex_radius;
  }
#endif
  bool outside_seen = base_radius + apex_radius > 0.0;
  float t = quadric_hit(base, axis, abs(base_radius), abs(apex_radius), outside_seen, ray, hit.t);
  if (t < hit.t) {
    hit.t = t;
    hit.kind = kind;
    hit.index = index;
  }
}
#endif

/* Test the primitives of one leaf and keep the nearest hit. Vector processors run all of it whatever the leaf holds: one test
 * for several kinds is faster than one for each. */
void primitive_leaf_hit(int kind, int first, int count, Ray ray, inout Hit hit)
{
#ifdef HAS_QUADRIC_LEAVES
  if (kind <= KIND_CONE) {
#ifdef HAS_SPHERE_RUNS
    for (int i = first; i < first + count; i++) {
      primitive_quadric_hit(kind, i, ray, hit);
    }
#else
    primitive_quadric_hit(kind, first, ray, hit);
#endif
  }
#else
#ifdef HAS_SPHERE_LEAVES
  if (kind == KIND_SPHERE) {
    PRIMITIVE_TESTS(KIND_SPHERE, read_sphere, sphere_hit, first, count)
  }
#endif
#endif
#ifdef HAS_DISC_LEAVES
  if (kind == KIND_DISC) {
    PRIMITIVE_TESTS(KIND_DISC, read_disc, disc_hit, first, count)
  }
#endif
#ifdef HAS_TRIANGLE_LEAVES
  if (kind == KIND_TRIANGLE) {
    PRIMITIVE_TESTS(KIND_TRIANGLE, read_triangle, triangle_hit, first, count)
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
