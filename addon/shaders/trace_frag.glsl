/* One sample of one pixel: the loop of the paper's 2.4.
 *
 * A path ray is the current ray; refracted rays wait on a stack, the reflected ray goes on as the current one. At a surface
 * that is lit, a shadow ray per light takes its turn before the path goes on. Path and shadow rays share the one call of the
 * traversal, since drivers inline it and it is most of the program. */
#include "camera_lib.glsl"
#include "shading_lib.glsl"
#include "world_lib.glsl"

#ifdef COUNT_RAYS
#define TRACE_COUNT(counter) counter += 1.0
#else
#define TRACE_COUNT(counter)
#endif

void main()
{
  float t_max;
  Ray eye = camera_ray(gl_FragCoord.xy, t_max);
  Path path = shading_path(eye, t_max, vec3(1.0), 1, medium_outside());
  Path stack[PATH_STACK_SIZE];
  int stacked = 0;
  Scattered scattered = shading_nothing(path); /* what goes on when the lights are done */
  Lit lit;
  Shadow shadow;
  int light = -1; /* the light whose shadow ray is on its way; -1: the path's own ray */

  vec3 radiance = vec3(0.0);
  float alpha = 1.0;
#ifdef HAS_SHADOW_CATCHER
  vec3 radiance_before = vec3(0.0);
  vec3 caught = vec3(0.0);
#endif
#ifdef COUNT_RAYS
  float eye_hits = 0.0, reflected = 0.0, refracted = 0.0, shadows = 0.0, dropped = 0.0;
#endif

  /* A driver may end a loop for good after so many turns, as Mesa's software rasteriser does after 65535 in all: what has not
   * ended by itself is told. The condition always holds; without one the compiler would take every end for the loop's own. */
  bool ended = false;
  while (frame_max_depth > 0.0) {
    bool is_shadow = light >= 0;
    Ray ray = path.ray;
    float limit = path.t_max;
    if (is_shadow) {
      ray = shadow.ray;
      limit = shadow.t_max;
    }
    Hit hit = bvh_traverse(ray, limit, is_shadow && !SHADOWS_PASS);
    bool missed = hit.kind < 0;
    bool sees_sky = missed && !is_shadow;
    bool path_ends = sees_sky;

    if (is_shadow) {
      if (missed) {
        radiance += shadow_arrived(shadow);
      }
      else if (SHADOWS_PASS && shadow_pass(shadow, hit)) {
        continue;
      }
      light++;
    }
    else if (!missed) {
#ifdef COUNT_RAYS
      eye_hits += path.depth == 1 ? 1.0 : 0.0;
#endif
      scattered = shading_scatter(path, hit, radiance, alpha, lit);
#ifdef HAS_SHADOW_CATCHER
      if (scattered.catches) { /* meanwhile `radiance` is the light on the catcher */
        radiance_before = radiance;
        radiance = vec3(0.0);
      }
#endif
      light = lit_is(lit) ? 0 : int(frame_light_count);
    }

    if (light >= 0) {
      shadow = shadow_next(light, lit, radiance);
#ifdef HAS_SHADOW_CATCHER
      if (scattered.catches && light == int(frame_light_count) && lit.shadow == RAY_SHADOW) {
        caught = radiance; /* now the same lights with the shadows of catchers alone */
        radiance = vec3(0.0);
        lit.shadow = RAY_SHADOW_OF_CATCHERS;
        light = 0;
        shadow = shadow_next(light, lit, radiance);
      }
#endif
      if (light < int(frame_light_count)) {
        TRACE_COUNT(shadows);
        continue;
      }
      light = -1;
      if (scattered.refracts) {
        TRACE_COUNT(refracted);
        if (!scattered.reflects) {
          path = scattered.refracted;
        }
        else if (stacked < PATH_STACK_SIZE) {
          stack[stacked++] = scattered.refracted;
        }
        else {
          TRACE_COUNT(dropped);
        }
      }
      if (scattered.reflects) {
        TRACE_COUNT(reflected);
        path = scattered.reflected;
      }
      path_ends = !scattered.reflects && !scattered.refracts;
#ifdef HAS_SHADOW_CATCHER
      if (scattered.catches) {
        path.weight *= shading_caught(caught, radiance);
        radiance = radiance_before;
        sees_sky = true;
      }
#endif
    }
    if (sees_sky) {
      if (frame_film_transparent > 0.5 && path.ray.kind == RAY_CAMERA) {
        alpha -= optics_mean(path.weight);
      }
      else {
        radiance += path.weight * world_radiance(path.ray.direction);
      }
    }
    if (path_ends) {
      if (stacked == 0) {
        ended = true;
        break;
      }
      path = stack[--stacked];
    }
  }
  out_color = vec4(radiance, ended ? alpha : UNENDED_ALPHA);
#ifdef COUNT_RAYS
  out_rays = vec4(eye_hits, reflected, refracted, shadows);
  out_dropped = vec4(dropped, 1.0, 0.0, 0.0);
#endif
}
