/* Shadow rays: from a lit surface to the lights, through what lets light pass. */
#include "lit_lib.glsl"
#include "light_lib.glsl"

#ifdef TINTED_SHADOWS
#define SHADOWS_PASS true
#else
#ifdef CULLED_SHADOWS
#define SHADOWS_PASS true
#else
#define SHADOWS_PASS false /* the first thing in the way ends a shadow ray */
#endif
#endif

/* A ray towards a light. */
struct Shadow {
  Ray ray;
  float t_max;
  vec3 contribution; /* to the pixel where nothing is in the way */
  vec3 tint;         /* what the surfaces and bodies that it has passed leave of it */
  ivec4 media;
  int surfaces; /* passed so far */
};

/* Where a shadow ray starts. A light that stands behind the flat triangle but before the smooth surface it stands for is
 * looked at from the latter: the triangle itself would be in the way. */
vec3 shadow_origin(Lit lit, vec3 direction)
{
  vec3 origin = ray_spawn(lit.surface, direction);
#ifdef HAS_TRIANGLE
  vec3 normal = lit.surface.geometric_normal;
  float side = dot(lit.normal, normal);
  if (dot(lit.normal, direction) > 0.0 && side * dot(direction, normal) < 0.0 && side * dot(lit.surface.lift, normal) > 0.0) {
    origin += lit.surface.lift;
  }
#endif
  return origin;
}

/* The shadow ray of the next light from `index` on that faces the surface and casts shadows; `index` becomes the number of
 * lights when there is none. Lights without shadows are added to `radiance` at once. */
Shadow shadow_next(inout int index, Lit lit, inout vec3 radiance)
{
  int count = int(frame_light_count);
  Shadow shadow;
  shadow.ray = ray_make(vec3(0.0), vec3(0.0, 0.0, 1.0), lit.shadow);
  shadow.t_max = 0.0;
  shadow.contribution = vec3(0.0);
  shadow.tint = vec3(0.0);
  shadow.media = lit.media;
  shadow.surfaces = 0;
  for (; index < count; index++) {
    Light light = read_light(index);
    vec3 direction;
    float t_max;
#ifdef HAS_LIGHT_SHAPES
    bool sampled = frame_sample >= 0.0;
    vec2 u = vec2(0.0);
    if (sampled) {
      u = sampling_2d(sampling_pixel(gl_FragCoord.xy), int(frame_sample), lit.depth * count + index);
    }
    vec3 arriving = light_shaped_at(light, index, lit.surface.position, sampled, u, direction, t_max);
    if (optics_largest(arriving) <= 0.0) {
      continue;
    }
#else
    vec3 arriving = light_at(light, lit.surface.position, direction, t_max);
#endif
    float cosine = dot(lit.normal, direction);
    if (cosine <= 0.0 && !lit_through(lit)) {
      continue;
    }
    vec3 contribution = lit_by(lit, arriving, direction, cosine);
    if (light.shadow < 0.5) {
      radiance += contribution;
      continue;
    }
    Ray ray = ray_make(shadow_origin(lit, direction), direction, lit.shadow);
    if (light.kind != LIGHT_SUN) { /* from where the ray starts, not from the surface */
      vec3 to_light = light.position - ray.origin;
      t_max = length(to_light);
      ray.direction = to_light / max(t_max, 1e-30);
    }
    shadow.ray = ray;
    shadow.t_max = t_max;
#ifdef HAS_ROUGHNESS
    shadow.media = cosine > 0.0 ? lit.media : lit.beyond;
#endif
    shadow.contribution = contribution;
    shadow.tint = vec3(1.0);
    break;
  }
  return shadow;
}

/* What a shadow ray brings when nothing more stands before the light. */
vec3 shadow_arrived(Shadow shadow)
{
  vec3 light = shadow.contribution * shadow.tint;
#ifdef HAS_ABSORPTION
  light *= optics_absorb(medium_absorption(shadow.media), shadow.t_max);
#endif
  return light;
}

/* Take a shadow ray through the surface that it has hit; false when it ends there or what is left is not worth following. */
bool shadow_pass(inout Shadow shadow, Hit hit)
{
  Surface surface = bvh_surface(hit, shadow.ray);
  Material material = material_at(surface);
  bool leaves = dot(shadow.ray.direction, surface.geometric_normal) > 0.0;
  bool culled = false;
#ifdef CULLED_SHADOWS
  culled = !leaves && material.cull_back_shadow > 0.5; /* as the light sees it, which looks the other way */
#endif
#ifdef TINTED_SHADOWS
  vec3 transmit = material.transmit;
#else
  vec3 transmit = vec3(0.0);
#endif
  shadow.tint *= culled ? vec3(1.0) : transmit;
#ifdef HAS_ABSORPTION
  bool borders = material.bounds_body > 0.5 && !culled;
  shadow.tint *= optics_absorb(borders && leaves ? material.absorption : medium_absorption(shadow.media), hit.t);
  if (borders) {
    shadow.media = leaves ? medium_leave(shadow.media, surface.material) : medium_enter(shadow.media, surface.material);
  }
#endif
  shadow.ray.origin = ray_spawn(surface, shadow.ray.direction);
  shadow.t_max -= hit.t;
  shadow.surfaces++;
  return optics_largest(shadow.tint) > frame_weight_cutoff && shadow.surfaces <= TINTED_SHADOW_SURFACES;
}
