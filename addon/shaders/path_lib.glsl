/* Paths: the ray that is followed, and those that wait for it. */
#include "medium_lib.glsl"
#include "ray_lib.glsl"
#include "sampling_lib.glsl"

/* A ray of the path and what it stands for. A camera ray has met nothing but surfaces that do not bend it. */
struct Path {
  Ray ray;
  float t_max;
  vec3 weight; /* its share of the pixel */
  int depth;   /* the eye ray is 1 */
  ivec4 media; /* the bodies it is inside of */
  float density;       /* of the rays of the lobe that it left, in its direction, times 2 pi; 0: the lights were asked already */
  float length_before; /* of the ray before the surfaces that it has passed since it was bent */
#ifdef HAS_LIGHT_PATH
  int passed; /* surfaces that did not bend its rays */
#endif
};

Path path_make(Ray ray, float t_max, vec3 weight, int depth, ivec4 media)
{
  Path path;
  path.ray = ray;
  path.t_max = t_max;
  path.weight = weight;
  path.depth = depth;
  path.media = media;
  path.density = SAMPLING_CERTAIN;
  path.length_before = 0.0;
#ifdef HAS_LIGHT_PATH
  path.passed = 0;
#endif
  return path;
}

/* A refracted path that waits while the reflected one is followed: few numbers, since processors store each of them lane by
 * lane. It reaches as far as there is anything. */
struct WaitingPath {
  vec3 origin, direction, weight;
  int depth_and_kind;
  ivec4 media;
  float length_before;
#ifdef HAS_ROUGHNESS
  float density;
#endif
#ifdef HAS_LIGHT_PATH
  int passed;
#endif
};

#define PATH_KINDS 32 /* more than any kind of path ray */

WaitingPath path_wait(Path path)
{
  WaitingPath waiting;
  waiting.origin = path.ray.origin;
  waiting.direction = path.ray.direction;
  waiting.weight = path.weight;
  waiting.depth_and_kind = path.depth * PATH_KINDS + path.ray.kind;
  waiting.media = path.media;
  waiting.length_before = path.length_before;
#ifdef HAS_ROUGHNESS
  waiting.density = path.density;
#endif
#ifdef HAS_LIGHT_PATH
  waiting.passed = path.passed;
#endif
  return waiting;
}

Path path_resume(WaitingPath waiting)
{
  int depth = waiting.depth_and_kind / PATH_KINDS;
  Ray ray = ray_make(waiting.origin, waiting.direction, waiting.depth_and_kind - depth * PATH_KINDS);
  Path path = path_make(ray, 1e30, waiting.weight, depth, waiting.media);
  path.length_before = waiting.length_before;
#ifdef HAS_ROUGHNESS
  path.density = waiting.density;
#endif
#ifdef HAS_LIGHT_PATH
  path.passed = waiting.passed;
#endif
  return path;
}
