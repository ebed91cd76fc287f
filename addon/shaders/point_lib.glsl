/* What a shader node sees: a place on a surface, or a direction into the sky. */
#include "ray_lib.glsl"

struct Point {
  vec3 position;    /* as rays have it, relative to the scene's origin; of the sky the direction */
  vec3 normal;      /* unit shading normal on the side of the ray; of the sky away from the direction */
  vec3 true_normal; /* the surface's own */
  vec3 incoming;    /* unit, to where the ray comes from */
  vec2 uv;
  bool backfacing;
  float ray_length;
  int ray_kind;
  int ray_depth; /* the eye ray's is 1 */
#ifdef HAS_LIGHT_PATH
  int passed; /* surfaces that did not bend the ray: `ray_length` goes through them, `ray_depth` does not count them */
#endif
  Surface surface;
};

Point point_of_surface(Surface surface, Ray ray, float t, int depth)
{
  float side = dot(ray.direction, surface.geometric_normal) > 0.0 ? -1.0 : 1.0;
  Point point;
  point.position = surface.position;
  point.normal = side * surface.shading_normal;
  point.true_normal = side * surface.geometric_normal;
  point.incoming = -ray.direction;
  point.uv = surface.uv;
  point.backfacing = side < 0.0;
  point.ray_length = t;
  point.ray_kind = ray.kind;
  point.ray_depth = depth;
#ifdef HAS_LIGHT_PATH
  point.passed = 0;
#endif
  point.surface = surface;
  return point;
}

/* The point of the sky that a ray looks at; `surface` stands for the one that is not there. */
Point point_of_sky(Surface surface, Ray ray, int depth)
{
  Point point = point_of_surface(surface, ray, 0.0, depth);
  point.position = ray.direction;
  point.normal = -ray.direction;
  point.true_normal = -ray.direction;
  point.uv = vec2(0.0);
  point.backfacing = false;
  return point;
}

/* What expressions call. */

vec3 point_position(Point point)
{
  return point.position;
}

vec3 point_normal(Point point)
{
  return point.normal;
}

vec3 point_incoming(Point point)
{
  return point.incoming;
}

vec2 point_uv(Point point)
{
  return point.uv;
}
