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
  Path path = shading_path(eye, t_max, vec3(1.0), 1, medium_outside(), true);
  Path stack[PATH_STACK_SIZE];
  int stacked = 0;
  Scattered scattered = shading_nothing(path); /* what goes on when the lights are done */
  Lit lit;
  Shadow shadow;
  int light = -1; /* the light whose shadow ray is on its way; -1: the path's own ray */

  vec3 radiance = vec3(0.0);
  float alpha = 1.0;
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
#ifdef TINTED_SHADOWS
    Hit hit = bvh_traverse(ray, limit, false);
#else
    Hit hit = bvh_traverse(ray, limit, is_shadow);
#endif
    bool missed = hit.kind < 0;
    bool path_ends = false;

    if (is_shadow) {
      if (missed) {
        radiance += shading_arrived(shadow);
      }
#ifdef TINTED_SHADOWS
      else if (shading_pass(shadow, hit)) {
        continue;
      }
#endif
      light++;
    }
    else if (missed) {
      if (frame_film_transparent > 0.5 && path.direct) {
        alpha -= (path.weight.r + path.weight.g + path.weight.b) / 3.0;
      }
      else {
        radiance += path.weight * world_radiance(ray.direction);
      }
      path_ends = true;
    }
    else {
#ifdef COUNT_RAYS
      eye_hits += path.depth == 1 ? 1.0 : 0.0;
#endif
      scattered = shading_scatter(path, hit, radiance, lit);
      bool shaded = optics_largest(lit.diffuse) > 0.0 || optics_largest(lit.highlight) > 0.0;
      light = shaded ? 0 : int(frame_light_count);
    }

    if (light >= 0) {
      shadow = shading_next_shadow(light, lit, radiance);
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
