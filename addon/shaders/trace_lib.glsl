/* One sample of one pixel: the loop of the paper's 2.4.
 *
 * A path ray is the current ray; refracted rays wait on a stack, the reflected ray goes on as the current one. At a surface
 * that is lit, a shadow ray per light takes its turn before the path goes on. Path and shadow rays share the one call of the
 * traversal, since drivers inline it and it is most of the program. Most shadow rays ask for no surface: they stay in the
 * inner loop, so that where pixels are worked on in step, all trace rays while one does and all shade while one does. */
#include "camera_lib.glsl"
#include "shading_lib.glsl"
#ifdef HAS_GUIDE
#include "guide_hit_lib.glsl"
#endif

#ifdef COUNT_RAYS
#define TRACE_COUNT(counter) counter += 1.0
#else
#define TRACE_COUNT(counter)
#endif

#ifdef HAS_GUIDE
/* Whether most of what the eye sees at a surface lies behind it: it is the hole of a cut-out. */
bool trace_sees_through(Path path, Scattered scattered)
{
#ifdef HAS_SHADOW_CATCHER
  if (scattered.catches) {
    return true;
  }
#endif
  bool straight = scattered.refracts && scattered.refracted.ray.kind == RAY_CAMERA;
  return straight && optics_mean(scattered.refracted.weight) > 0.5 * optics_mean(path.weight);
}
#endif

/* Whether what a shadow ray meets is asked what it lets pass, or the sky how bright it is. */
bool trace_asks(Shadow shadow, Hit hit)
{
  bool asks = SHADOWS_PASS && frame_shadows_pass > 0.5 && hit.kind >= 0;
#ifdef HAS_WORLD_LIGHT
  asks = asks || (hit.kind < 0 && shadow.to_world);
#endif
  return asks;
}

/* What a sample adds to the film, an attachment a member. */
struct Traced {
  vec4 color;
#ifdef HAS_OUTLINES
  vec4 guide;
#endif
#ifdef COUNT_RAYS
  vec4 rays, dropped;
#endif
};

Traced trace_sample()
{
  float t_max;
  Ray eye = camera_ray(PIXEL, t_max);
  Path path = path_make(eye, t_max, vec3(1.0), 1, medium_outside());
  bool path_ends = false; /* no path goes on when the lights are done */
  WaitingPath stack[PATH_STACK_SIZE + 1];
  int stacked = 0;
  Lit lit;
  Shadow shadow;
  bool shadow_goes_on = false; /* it has passed a surface: the light has still to be reached */
  int turns = shadow_turns();
  int light = turns; /* the light whose turn it is; then comes the path's own ray */

  vec3 radiance = vec3(0.0);
  float alpha = 1.0;
#ifdef HAS_SHADOW_CATCHER
  bool catches = false; /* lit is a catcher, and `radiance` the light on it alone */
  vec3 radiance_before = vec3(0.0);
  vec3 caught = vec3(0.0);
#endif
#ifdef HAS_GUIDE
  vec4 guide = vec4(0.0);
#endif
#ifdef HAS_DEPTH_CUE
  bool cued = false;
#endif
#ifdef COUNT_RAYS
  float eye_hits = 0.0, reflected = 0.0, refracted = 0.0, shadows = 0.0, dropped = 0.0;
#endif

  /* A driver may end a loop for good after so many turns, as Mesa's software rasteriser does after 65535 in all: what has not
   * ended by itself is told. The condition always holds; without one the compiler would take every end for the loop's own. */
  bool ended = false;
  while (frame_max_depth > 0.0) {
    bool is_shadow = false;
    Ray ray = path.ray;
    Hit hit;
    while (true) {
#ifdef HAS_SHADOW_CATCHER
      if (catches && light == turns && lit.shadow == RAY_SHADOW) {
        caught = radiance; /* now the same lights with the shadows of catchers alone */
        radiance = vec3(0.0);
        lit.shadow = RAY_SHADOW_OF_CATCHERS;
        light = 0;
      }
#endif
      if (light < turns && !shadow_goes_on) {
        shadow = shadow_next(light, lit, radiance);
#ifdef COUNT_RAYS
        shadows += light < turns ? 1.0 : 0.0;
#endif
      }
      is_shadow = light < turns;
#ifdef HAS_SHADOW_CATCHER
      if (catches && !is_shadow) {
        if (lit.shadow == RAY_SHADOW) {
          continue;
        }
        path.weight *= shading_caught(caught, radiance);
        radiance = radiance_before;
        catches = false;
      }
#endif
      if (!is_shadow && path_ends) {
        break;
      }
      float limit = path.t_max;
      ray = path.ray;
      if (is_shadow) {
        ray = shadow.ray;
        limit = shadow.t_max;
      }
      hit = bvh_traverse(ray, limit, is_shadow && !(SHADOWS_PASS && frame_shadows_pass > 0.5));
      if (!is_shadow || trace_asks(shadow, hit)) {
        break;
      }
      radiance += hit.kind < 0 ? shadow_arrived(shadow) : vec3(0.0);
      shadow_goes_on = false;
      light++;
    }
    if (!is_shadow && path_ends) {
#ifdef HAS_DEPTH_CUE
      if (guide_is_hit(guide) && !cued) {
        float cue = guide_depth_cue(guide.x);
        radiance = mix(radiance, alpha * frame_depth_cue_color, cue);
        cued = true;
        if (frame_depth_cue_background > 0.5) { /* what is behind everything shows through what is far */
          path = path_make(eye, 0.0, vec3(cue * alpha), 1, medium_outside());
          path_ends = false;
          continue;
        }
      }
#endif
      ended = true;
      break;
    }

    /* One call for surfaces and sky, path and shadow rays: drivers inline it too. */
    bool missed = hit.kind < 0;
    Surface surface = bvh_surface(hit, ray);
    int depth = is_shadow ? lit.depth : path.depth;
    Point point = point_of_surface(surface, ray, hit.t, depth);
    if (missed) {
      point = point_of_sky(surface, ray, depth);
      point.ray_kind = is_shadow ? RAY_DIFFUSE : ray.kind;
    }
#ifdef HAS_LIGHT_PATH
    int passed = is_shadow ? lit.passed : path.passed;
    point.ray_depth -= passed;
    point.passed = passed + (is_shadow ? shadow.surfaces : 0);
    point.ray_length += is_shadow ? 0.0 : path.length_before;
#endif
    Material material = material_at(missed ? int(frame_world_material) : surface.material, point);

    if (is_shadow) {
      shadow_goes_on = !missed && shadow_pass(shadow, hit.t, surface, material);
#ifdef HAS_WORLD_LIGHT
      radiance += missed ? shadow_arrived(shadow) * material.glow : vec3(0.0);
#endif
      light += shadow_goes_on ? 0 : 1;
      continue;
    }
#ifdef HAS_SEEN_LAMPS
    radiance += shading_lamps(path, hit.t, missed);
#endif
    path_ends = missed;
    if (missed) {
      if (frame_film_transparent > 0.5 && path.ray.kind == RAY_CAMERA) {
        alpha -= optics_mean(path.weight);
      }
      else if ((int(frame_world_visibility) & path.ray.kind) != 0) {
        vec3 seen = path.weight * material.glow;
#ifdef HAS_WORLD_GLOSS
        seen *= sampling_weight(path.density, world_light_density(path.ray.direction));
#endif
        radiance += seen;
      }
    }
    else {
#ifdef COUNT_RAYS
      eye_hits += path.depth == 1 ? 1.0 : 0.0;
#endif
      Scattered scattered = shading_scatter(path, hit, surface, material, radiance, alpha, lit);
#ifdef HAS_GUIDE
      if (path.ray.kind == RAY_CAMERA && !guide_is_hit(guide) && !trace_sees_through(path, scattered)) {
        guide = guide_hit_make(hit, point);
      }
#endif
      light = lit_is(lit) ? 0 : turns;
#ifdef FLAT_COLORS
      radiance += lit.diffuse + path.weight * material.metallic;
      scattered.reflects = false;
      light = turns;
#endif
#ifdef HAS_TRANSMISSION
      stack[stacked] = path_wait(scattered.refracted); /* it waits only where both rays go on; see bvh_traverse */
      if (scattered.refracts && scattered.reflects) {
        if (stacked < PATH_STACK_SIZE) {
          stacked++;
        }
        else {
          TRACE_COUNT(dropped);
        }
      }
#endif
#ifdef COUNT_RAYS
      refracted += scattered.refracts ? 1.0 : 0.0;
      reflected += scattered.reflects ? 1.0 : 0.0;
#endif
      path_ends = !scattered.reflects && !scattered.refracts;
      if (scattered.reflects) {
        path = scattered.reflected;
      }
      else if (scattered.refracts) {
        path = scattered.refracted;
      }
#ifdef HAS_SHADOW_CATCHER
      catches = scattered.catches;
      if (catches) { /* meanwhile `radiance` is the light on the catcher */
        radiance_before = radiance;
        radiance = vec3(0.0);
        path.t_max = 0.0; /* on it goes, to where there is nothing but the sky */
        path_ends = false;
      }
#endif
    }
#ifdef HAS_TRANSMISSION
    if (path_ends && stacked > 0) {
      stacked--;
      path = path_resume(stack[stacked]);
      path_ends = false;
    }
#endif
#ifndef HAS_DEPTH_CUE
    /* As above, where no light has to be asked before: what is worked on in step need not go through all of it once more. */
    ended = path_ends && light == turns;
    if (ended) {
      break;
    }
#endif
  }
  Traced traced;
  traced.color = vec4(radiance, ended ? alpha : UNENDED_ALPHA);
#ifdef HAS_OUTLINES
  traced.guide = guide;
#endif
#ifdef COUNT_RAYS
  traced.rays = vec4(eye_hits, reflected, refracted, shadows);
  traced.dropped = vec4(dropped, 1.0, 0.0, 0.0);
#endif
  return traced;
}
