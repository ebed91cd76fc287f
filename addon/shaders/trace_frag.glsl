/* One sample of one pixel: the loop of the paper's 2.4.
 *
 * A path ray is the current ray; refracted rays wait on a stack, the reflected ray goes on as the current one. At a surface
 * that is lit, a shadow ray per light takes its turn before the path goes on. Path and shadow rays share the one call of the
 * traversal, since drivers inline it and it is most of the program. */
#include "camera_lib.glsl"
#include "bvh_lib.glsl"
#include "material_lib.glsl"
#include "medium_lib.glsl"
#include "optics_lib.glsl"
#include "light_lib.glsl"
#include "world_lib.glsl"

/* A ray of the path and what it stands for. */
struct Path {
  Ray ray;
  float t_max;
  vec3 weight; /* its share of the pixel */
  int depth;   /* the eye ray is 1 */
  ivec4 media; /* the bodies it is inside of */
  bool direct; /* straight from the eye, through nothing but surfaces that do not bend it */
};

/* A surface being lit. */
struct Lit {
  Surface surface;
  vec3 normal; /* shading normal on the side of the path ray */
  vec3 view;   /* direction of the path ray */
  vec3 diffuse;
  vec3 highlight;
  float shine;
  ivec4 media; /* around the lit side */
};

#ifdef COUNT_RAYS
#define TRACE_COUNT(counter) counter += 1.0
#else
#define TRACE_COUNT(counter)
#endif

/* The next light from `index` on that faces the surface; `index` becomes the number of lights when there is none.
 * `contribution` is what its light adds to the pixel where nothing is in the way. */
void trace_next_light(inout int index, Lit lit, out Ray shadow, out float t_max, out vec3 contribution)
{
  int count = int(frame.light_count);
  contribution = vec3(0.0);
  shadow = Ray(vec3(0.0), vec3(0.0, 0.0, 1.0));
  t_max = 0.0;
  for (; index < count; index++) {
    Light light = read_light(index);
    vec3 direction;
    vec3 radiance = light_at(light, lit.surface.position, direction, t_max);
    float cosine = dot(lit.normal, direction);
    if (cosine <= 0.0) {
      continue;
    }
    float alignment = max(dot(optics_mirror(lit.view, lit.normal), direction), 0.0);
    contribution = radiance * (lit.diffuse * cosine);
    if (optics_largest(lit.highlight) > 0.0 && alignment > 0.0) {
      contribution += radiance * lit.highlight * pow(alignment, lit.shine);
    }
    shadow = Ray(ray_spawn(lit.surface, direction), direction);
    if (light.kind != LIGHT_SUN) { /* from where the ray starts, not from the surface */
      vec3 to_light = light.position - shadow.origin;
      t_max = length(to_light);
      shadow.direction = to_light / max(t_max, 1e-30);
    }
    return;
  }
}

void main()
{
  float t_max;
  Ray eye = camera_ray(gl_FragCoord.xy, t_max);
  Path path = Path(eye, t_max, vec3(1.0), 1, medium_outside(), true);
  Path stack[PATH_STACK_SIZE];
  int stacked = 0;

  vec3 radiance = vec3(0.0);
  float alpha = 1.0;
#ifdef COUNT_RAYS
  float eye_hits = 0.0, reflected = 0.0, refracted = 0.0, shadows = 0.0, dropped = 0.0;
#endif

  Lit lit;
  int light = -1; /* the light whose shadow ray is on its way; -1: the path's own ray */
  vec3 contribution = vec3(0.0);
  vec3 shadow_tint = vec3(1.0);
  ivec4 shadow_media = medium_outside();
  int shadow_surfaces = 0;
  Ray shadow;
  float shadow_t_max = 0.0;
  /* What goes on from the surface when its lights are done. */
  Path reflected_path = path;
  Path refracted_path = path;
  bool reflects = false;
  bool refracts = false;

  /* A driver may end a loop for good after so many turns, as Mesa's software rasteriser does after 65535 in all: what has not
   * ended by itself is told. The condition always holds; without one the compiler would take every end for the loop's own. */
  bool ended = false;
  while (frame.max_depth > 0.0) {
    bool is_shadow = light >= 0;
    Ray ray = path.ray;
    float limit = path.t_max;
    if (is_shadow) {
      ray = shadow;
      limit = shadow_t_max;
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
#ifdef HAS_ABSORPTION
        shadow_tint *= optics_absorb(medium_absorption(shadow_media), limit);
#endif
        radiance += contribution * shadow_tint;
      }
#ifdef TINTED_SHADOWS
      else if (shadow_surfaces < TINTED_SHADOW_SURFACES) {
        Surface surface = bvh_surface(hit, ray);
        Material material = material_at(surface.material, surface.uv);
        bool leaves = dot(ray.direction, surface.geometric_normal) > 0.0;
        shadow_tint *= material.transmit;
#ifdef HAS_ABSORPTION
        shadow_tint *= optics_absorb(leaves ? material.absorption : medium_absorption(shadow_media), hit.t);
        shadow_media = leaves ? medium_leave(shadow_media, surface.material) : medium_enter(shadow_media, surface.material);
#endif
        if (optics_largest(shadow_tint) > frame.weight_cutoff) {
          shadow.origin = ray_spawn(surface, ray.direction);
          shadow_t_max -= hit.t;
          shadow_surfaces++;
          continue;
        }
      }
#endif
      light++;
    }
    else if (missed) {
      if (frame.film_transparent > 0.5 && path.direct) {
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
      Surface surface = bvh_surface(hit, ray);
      Material material = material_at(surface.material, surface.uv);
      bool entering = dot(ray.direction, surface.geometric_normal) < 0.0;
      vec3 normal = entering ? surface.shading_normal : -surface.shading_normal;
      vec3 face = entering ? surface.geometric_normal : -surface.geometric_normal;
      if (dot(normal, ray.direction) >= 0.0) { /* an interpolated normal that looks away: the surface's own is the truth */
        normal = face;
      }
      float cos_i = min(-dot(normal, ray.direction), 1.0);
      vec3 weight = path.weight;
      bool transmits = optics_largest(material.transmit) > 0.0;
#ifdef HAS_ABSORPTION
      /* A ray that leaves a body has been inside it, even if it was not seen entering (the eye was inside). The back of an
       * opaque surface bounds no body. */
      bool leaves = transmits && !entering;
      weight *= optics_absorb(leaves ? material.absorption : medium_absorption(path.media), hit.t);
#endif
      radiance += weight * material.glow;

      ivec4 media_beyond = path.media;
      float eta = 1.0 / material.ior; /* a coat is on both sides of a surface that borders on no medium */
      if (transmits) {
        media_beyond = entering ? medium_enter(path.media, surface.material) : medium_leave(path.media, surface.material);
        eta = entering ? medium_ior(path.media) / material.ior : material.ior / medium_ior(media_beyond);
      }
      float cos_t;
      float fresnel = optics_fresnel(cos_i, eta, cos_t);
      bool total = transmits && cos_t == 0.0;
      vec3 mirror = material.reflect;
      vec3 through = total ? vec3(0.0) : material.transmit;
      vec3 diffuse = material.diffuse;
      if (material.fresnel > 0.5) {
        mirror *= fresnel;
        through *= 1.0 - fresnel;
        diffuse *= 1.0 - fresnel * optics_largest(material.reflect);
      }
      else if (total) {
        mirror += material.transmit;
      }

      bool deeper = path.depth < int(frame.max_depth);
      vec3 mirror_weight = weight * mirror;
      vec3 through_weight = weight * through;
      reflects = deeper && optics_largest(mirror_weight) > frame.weight_cutoff;
      refracts = deeper && optics_largest(through_weight) > frame.weight_cutoff;
      if (reflects) {
        vec3 direction = optics_mirror(ray.direction, normal);
        float below = dot(direction, face);
        if (below <= 0.0) { /* an interpolated normal bent it into the surface: let it graze */
          direction = normalize(direction + (1e-3 - below) * face);
        }
        reflected_path = Path(Ray(ray_spawn(surface, direction), direction), 1e30, mirror_weight, path.depth + 1, path.media, false);
      }
      if (refracts) {
        vec3 direction = optics_refract(ray.direction, normal, cos_i, cos_t, eta);
        float above = dot(direction, face);
        if (above >= 0.0) {
          direction = normalize(direction - (1e-3 + above) * face);
        }
        refracted_path = Path(Ray(ray_spawn(surface, direction), direction), 1e30, through_weight, path.depth + 1, media_beyond,
                              path.direct && eta == 1.0);
      }
      lit = Lit(surface, normal, ray.direction, weight * diffuse, weight * material.highlight, material.shine, path.media);
      bool shaded = optics_largest(lit.diffuse) > 0.0 || optics_largest(lit.highlight) > 0.0;
      light = shaded ? 0 : int(frame.light_count);
    }

    if (light >= 0) {
      trace_next_light(light, lit, shadow, shadow_t_max, contribution);
      if (light < int(frame.light_count)) {
        TRACE_COUNT(shadows);
        shadow_tint = vec3(1.0);
        shadow_media = lit.media;
        shadow_surfaces = 0;
        continue;
      }
      light = -1;
      if (refracts) {
        TRACE_COUNT(refracted);
        if (!reflects) {
          path = refracted_path;
        }
        else if (stacked < PATH_STACK_SIZE) {
          stack[stacked++] = refracted_path;
        }
        else {
          TRACE_COUNT(dropped);
        }
      }
      if (reflects) {
        TRACE_COUNT(reflected);
        path = reflected_path;
      }
      path_ends = !reflects && !refracts;
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
