/* Shadow rays: from a lit surface to the lights, through what lets light pass. */
#include "lit_lib.glsl"
#include "light_lib.glsl"
#ifdef HAS_LIGHT_TREE
#include "light_tree_lib.glsl"
#endif
#include "world_light_lib.glsl"

#ifdef TINTED_SHADOWS
#define SHADOWS_PASS true
#else
#ifdef TRANSPARENT_SHADOWS
#define SHADOWS_PASS true
#else
#ifdef CULLED_SHADOWS
#define SHADOWS_PASS true
#else
#ifdef HAS_VARYING_EMITTERS
#define SHADOWS_PASS true
#else
#define SHADOWS_PASS false /* the first thing in the way ends a shadow ray */
#endif
#endif
#endif
#endif

#define SHADOW_WORLD 0x40000000 /* what is sampled of the world has numbers that lamps do not reach */

/* A ray towards a light. */
struct Shadow {
  Ray ray;
  float t_max;
  vec3 contribution; /* to the pixel where nothing is in the way */
  vec3 tint;         /* what the surfaces and bodies that it has passed leave of it */
  ivec4 media;
  int surfaces; /* passed so far */
#ifdef HAS_ROUGHNESS
  vec3 contribution_bent; /* what is left where mirrors' rays on this way are bent or end: they find the light themselves */
#endif
#ifdef HAS_WORLD_LIGHT
  bool to_world; /* the contribution is to be multiplied by what the ray sees */
#endif
#ifdef HAS_VARYING_EMITTERS
  float t_glow; /* what is met from here on is the light, whose glow there multiplies the contribution; 1e30: no such light */
#endif
};

/* How many turns a lit surface takes for lights: one for each, or for those that are chosen from many; surfaces that glow are
 * lights where a pixel has more than one sample. */
int shadow_light_turns()
{
  bool sampled = frame_sample >= 0.0;
#ifdef HAS_LIGHT_TREE
  return sampled ? LIGHT_PICKS : int(frame_light_cut_end);
#else
  return int(frame_light_count) + (sampled ? int(frame_emitter_count) : 0);
#endif
}

/* How many in all: then those of the world. */
int shadow_turns()
{
  int turns = shadow_light_turns();
#ifdef HAS_WORLD_LIGHT
  turns += 1;
#endif
#ifdef HAS_HEMISPHERE_LIGHT
  turns += 1;
#endif
#ifdef HAS_AMBIENT_OCCLUSION
  turns += int(frame_ao_rays);
#endif
  return turns;
}

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

#ifdef HAS_WORLD_LIGHT
/* Make `shadow` a ray towards the world: mirrors have rays of their own as well. False where it brings nothing. */
bool shadow_to_world(inout Shadow shadow, Lit lit)
{
  vec2 u = sampling_2d(sampling_pixel(PIXEL), int(frame_sample), SHADOW_WORLD + lit.depth);
  float scale;
  vec3 direction = world_light_direction(lit.normal, lit_behind(lit), u, scale);
  float cosine = dot(lit.normal, direction);
  vec3 arriving = vec3(scale);
#ifdef HAS_PLAIN_WORLD
  arriving *= frame_world_radiance;
#else
  shadow.to_world = true;
#endif
  shadow.contribution = arriving * lit_diffuse(lit, direction, cosine);
#ifdef HAS_ROUGHNESS
  shadow.contribution_bent = shadow.contribution;
#endif
#ifdef HAS_WORLD_GLOSS
  shadow.contribution += arriving * lit_glossy(lit, direction, world_light_density(direction));
#endif
  shadow.tint = vec3(1.0);
  shadow.ray = ray_make(shadow_origin(lit, direction), direction, lit.shadow);
  shadow.t_max = 1e30;
#ifdef HAS_ROUGHNESS
  shadow.media = lit_before(lit, direction, cosine) ? lit.media : lit.beyond;
#endif
  return optics_largest(shadow.contribution) > 0.0;
}
#endif

#ifdef HAS_HEMISPHERE_LIGHT
/* What all of the world adds where nothing is in the way. */
vec3 shadow_hemisphere(Lit lit)
{
  vec3 light = lit_diffuse(lit, lit.normal, 1.0) * world_light_hemisphere(lit.normal);
  return light + lit_diffuse(lit, -lit.normal, -1.0) * world_light_hemisphere(-lit.normal);
}
#endif

#ifdef HAS_AMBIENT_OCCLUSION
/* Make `shadow` number `ray` of the rays that ask whether what is near lets the world's light pass. */
bool shadow_to_near(inout Shadow shadow, Lit lit, int ray)
{
  vec2 u = sampling_2d(sampling_pixel(PIXEL), int(frame_sample), SHADOW_WORLD + lit.depth);
  vec3 direction = world_light_ambient_direction(lit.normal, ray, u);
  shadow.contribution = shadow_hemisphere(lit) * (frame_ao_factor / frame_ao_rays);
  shadow.tint = vec3(1.0);
  shadow.ray = ray_make(shadow_origin(lit, direction), direction, lit.shadow);
  shadow.t_max = frame_ao_distance;
  return optics_largest(shadow.contribution) > 0.0;
}
#endif

/* Likewise of the turns after the lamps; `turn` counts from 0. False where the turn needs no ray. */
bool shadow_of_world(inout Shadow shadow, Lit lit, int turn, inout vec3 radiance)
{
#ifdef HAS_WORLD_LIGHT
  return shadow_to_world(shadow, lit);
#else
#ifdef HAS_AMBIENT_OCCLUSION
  if (turn > 0) {
    return shadow_to_near(shadow, lit, turn - 1);
  }
  radiance += (1.0 - frame_ao_factor) * shadow_hemisphere(lit);
#else
#ifdef HAS_HEMISPHERE_LIGHT
  radiance += shadow_hemisphere(lit);
#endif
#endif
  return false;
#endif
}

/* A surface as a light is seen by it. */
Lit shadow_seeing(Lit lit, Light light)
{
#ifdef HAS_LIGHT_VISIBILITY
  if ((light.visibility & VISIBILITY_DIFFUSE) == 0) {
    lit.diffuse = vec3(0.0);
#ifdef HAS_TRANSLUCENT
    lit.translucent = vec3(0.0);
#endif
  }
  if ((light.visibility & VISIBILITY_GLOSSY) == 0) {
    lit.highlight = vec3(0.0);
#ifdef HAS_ROUGHNESS
    lit.material.reflect = vec3(0.0);
    lit.material.metallic = vec3(0.0);
    lit.material.grazing = vec3(0.0);
    lit.material.coat = vec3(0.0);
#endif
  }
#ifdef HAS_ROUGHNESS
  if ((light.visibility & VISIBILITY_TRANSMISSION) == 0) {
    lit.material.transmit = vec3(0.0);
  }
#endif
#endif
  return lit;
}

#ifdef HAS_EMITTERS
/* How far before a point of a surface that glows a shadow ray ends, so that the surface does not shade itself: what rounding
 * moves where it is met, unless nearly along it. */
#define SHADOW_SLACK 32.0

float shadow_slack(vec3 position, float range)
{
  return min(SHADOW_SLACK * ray_error(position, range), 0.5 * range);
}
#endif

/* Make `shadow` the ray of turn `index` to the light that it asks; false where no ray is needed. Light without shadow is added
 * to `radiance` at once. */
bool shadow_to_light(inout Shadow shadow, inout Lit lit, inout int index, inout vec3 radiance)
{
  int number = index;
  float weight = 1.0;
#ifdef HAS_LIGHT_TREE
  bool around = lit_through(lit);
  if (index == 0 && frame_sample >= 0.0) {
    lit.light_total = light_tree_total(lit.surface.position, lit.normal, around);
  }
  LightChoice choice =
      light_tree_choose(index, lit.surface.position, lit.normal, around, lit.light_total, lit.depth);
  number = choice.light;
  weight = choice.weight;
  if (number < 0) {
    return false;
  }
#endif
  Light light = read_light(number);
  vec3 direction;
  float t_max;
#ifdef HAS_LIGHT_SHAPES
  vec3 color = light.color;
  bool sampled = frame_sample >= 0.0;
  vec2 u = vec2(0.0);
  if (sampled) {
#ifdef HAS_LIGHT_TREE
    int dimension = (lit.depth * LIGHT_PICKS + index) * 2 + 1;
#else
    int dimension = lit.depth * shadow_light_turns() + index;
#endif
    u = sampling_2d(sampling_pixel(PIXEL), int(frame_sample), dimension);
  }
  vec3 arriving = weight * light_shaped_at(light, number, lit.surface.position, sampled, u, direction, t_max);
  if (optics_largest(arriving) <= 0.0) {
    return false;
  }
#else
  vec3 arriving = light_at(light, lit.surface.position, direction, t_max);
#endif
#ifdef HAS_LIGHT_TREE
  if (choice.is_many) {
    arriving = light_tree_gathered(choice.node, arriving, color, t_max, lit.surface.position, direction);
  }
#endif
#ifdef HAS_LIGHT_LINKING
  if ((lit.visibility & light.receivers) != light.receivers) {
    return false;
  }
#endif
  float cosine = dot(lit.normal, direction);
  bool before = lit_before(lit, direction, cosine);
  if (!before && !lit_through(lit)) {
    return false;
  }
  Lit seeing = shadow_seeing(lit, light);
  vec3 contribution = arriving * lit_plain(seeing, direction, cosine);
#ifdef HAS_ROUGHNESS
  float asked = SAMPLING_ALWAYS;
#ifdef HAS_LIGHT_SHAPES
  asked = sampled ? light_density(light.kind == LIGHT_SUN ? 1.0 : t_max, read_light_shape(number).seen_area) : asked;
#endif
  vec3 glossy = arriving * lit_glossy(seeing, direction, asked);
  shadow.contribution_bent = contribution + (asked < SAMPLING_ALWAYS ? vec3(0.0) : glossy);
  contribution += glossy;
#endif
  if ((light.visibility & RAY_SHADOW) == 0) {
    radiance += contribution;
    return false;
  }
  Ray ray = ray_make(shadow_origin(lit, direction), direction, lit.shadow);
  if (light.kind != LIGHT_SUN) { /* from where the ray starts, not from the surface */
    vec3 to_light = light.position - ray.origin;
    t_max = length(to_light);
    ray.direction = to_light / max(t_max, 1e-30);
  }
#ifdef HAS_LIGHT_LINKING
  ray.kind += light.blockers;
#endif
#ifdef HAS_EMITTERS
  if (light.emitter > 0) {
    float slack = shadow_slack(light.position, t_max);
#ifdef HAS_VARYING_EMITTERS
    shadow.t_glow = light.emitter == EMITTER_VARIES ? t_max - slack : 1e30;
    t_max += light.emitter == EMITTER_VARIES ? slack : -slack;
#else
    t_max -= slack;
#endif
  }
#endif
  shadow.ray = ray;
  shadow.t_max = t_max;
#ifdef HAS_ROUGHNESS
  shadow.media = before ? lit.media : lit.beyond;
#endif
  shadow.contribution = contribution;
  shadow.tint = vec3(1.0);
  return optics_largest(contribution) > 0.0;
}

/* The shadow ray of the next turn from `index` on whose light reaches the surface and casts shadows; `index` becomes the
 * number of turns when there is none. Light without shadows is added to `radiance` at once. */
Shadow shadow_next(inout int index, inout Lit lit, inout vec3 radiance)
{
  Shadow shadow;
  shadow.ray = ray_make(vec3(0.0), vec3(0.0, 0.0, 1.0), lit.shadow);
  shadow.t_max = 0.0;
  shadow.contribution = vec3(0.0);
  shadow.tint = vec3(0.0);
  shadow.media = lit.media;
  shadow.surfaces = 0;
#ifdef HAS_ROUGHNESS
  shadow.contribution_bent = vec3(0.0);
#endif
#ifdef HAS_WORLD_LIGHT
  shadow.to_world = false;
#endif
#ifdef HAS_VARYING_EMITTERS
  shadow.t_glow = 1e30;
#endif
  int lights = shadow_light_turns();
  while (index < lights && !shadow_to_light(shadow, lit, index, radiance)) {
    index++;
  }
  if (index >= lights) {
    int turns = shadow_turns();
    while (index < turns && !shadow_of_world(shadow, lit, index - lights, radiance)) {
      index++;
    }
  }
  return shadow;
}

/* What a shadow ray brings when nothing more stands before the light. */
vec3 shadow_arrived(Shadow shadow)
{
  vec3 light = shadow.contribution * shadow.tint;
#ifdef HAS_VARYING_EMITTERS
  light *= shadow.t_glow < 1e29 ? 0.0 : 1.0; /* its light was not there */
#endif
#ifdef HAS_ABSORPTION
  light *= optics_absorb(medium_absorption(shadow.media), shadow.t_max);
#endif
  return light;
}

/* The share of a light that its shadow rays take along through a surface. */
vec3 shadow_passed(Material material)
{
#ifdef TINTED_SHADOWS
  return material.transmit;
#else
#ifdef TRANSPARENT_SHADOWS
  return material.straight;
#else
  return vec3(0.0);
#endif
#endif
}

/* Take a shadow ray through the surface that it has hit after `t`; false when it ends there or what is left is not worth following. */
bool shadow_pass(inout Shadow shadow, float t, Surface surface, Material material)
{
  bool leaves = dot(shadow.ray.direction, surface.geometric_normal) > 0.0;
  bool culled = false;
#ifdef CULLED_SHADOWS
  culled = !leaves && material.cull_back_shadow > 0.5; /* as the light sees it, which looks the other way */
#endif
  bool glows = false;
#ifdef HAS_VARYING_EMITTERS
  glows = t >= shadow.t_glow;
#endif
#ifdef HAS_ROUGHNESS
  if (!glows && (culled || material.ior != 1.0)) {
    shadow.contribution = shadow.contribution_bent;
  }
#endif
#ifdef HAS_VARYING_EMITTERS
  shadow.contribution *= glows ? material.glow : vec3(1.0);
  shadow.t_glow = glows ? 1e30 : shadow.t_glow - t;
  shadow.t_max = glows ? t : shadow.t_max; /* there it ends */
  culled = culled || glows;
#endif
  shadow.tint *= culled ? vec3(1.0) : shadow_passed(material);
#ifdef HAS_ABSORPTION
  bool borders = material.bounds_body > 0.5 && !culled;
  shadow.tint *= optics_absorb(borders && leaves ? material.absorption : medium_absorption(shadow.media), t);
  if (borders) {
    shadow.media = leaves ? medium_leave(shadow.media, surface.material) : medium_enter(shadow.media, surface.material);
  }
#endif
  shadow.ray.origin = ray_spawn(surface, shadow.ray.direction);
  shadow.t_max -= t;
  shadow.surfaces++;
  return optics_largest(shadow.tint) > frame_weight_cutoff && shadow.surfaces <= SHADOW_SURFACES;
}
