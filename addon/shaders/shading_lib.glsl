/* What happens where a ray meets a surface: paper 2.4, step 2. Light that is given off, the lights' shadow rays, and the two
 * rays that go on from there. */
#include "bvh_lib.glsl"
#include "material_lib.glsl"
#include "medium_lib.glsl"
#include "optics_lib.glsl"
#include "light_lib.glsl"
#ifdef HAS_ROUGHNESS
#include "gloss_lib.glsl"
#endif

#ifdef TINTED_SHADOWS
#define SHADING_SHADOWS_PASS true
#else
#ifdef CULLED_SHADOWS
#define SHADING_SHADOWS_PASS true
#else
#define SHADING_SHADOWS_PASS false /* the first thing in the way ends a shadow ray */
#endif
#endif

/* A ray of the path and what it stands for. A camera ray has met nothing but surfaces that do not bend it. */
struct Path {
  Ray ray;
  float t_max;
  vec3 weight; /* its share of the pixel */
  int depth;   /* the eye ray is 1 */
  ivec4 media; /* the bodies it is inside of */
};

Path shading_path(Ray ray, float t_max, vec3 weight, int depth, ivec4 media)
{
  Path path;
  path.ray = ray;
  path.t_max = t_max;
  path.weight = weight;
  path.depth = depth;
  path.media = media;
  return path;
}

/* A surface being lit. */
struct Lit {
  Surface surface;
  vec3 normal; /* shading normal on the side of the path ray */
  vec3 view;   /* direction of the path ray */
  vec3 diffuse;
  vec3 highlight;
  float shine;
  ivec4 media; /* around the lit side */
  int shadow;  /* kind of the shadow rays */
#ifdef HAS_LIGHT_SHAPES
  int depth; /* of the path ray */
#endif
#ifdef HAS_ROUGHNESS
  Material material; /* with shares of the pixel */
  float eta;         /* index on the lit side over the one beyond */
  ivec4 beyond;      /* media around the other side */
#endif
};

/* A ray towards a light. */
struct Shadow {
  Ray ray;
  float t_max;
  vec3 contribution; /* to the pixel where nothing is in the way */
  vec3 tint;         /* what the surfaces and bodies that it has passed leave of it */
  ivec4 media;
  int surfaces; /* passed so far */
};

/* The rays that go on from a surface, each of them if its `..s` holds. */
struct Scattered {
  bool reflects;
  Path reflected;
  bool refracts;
  Path refracted;
#ifdef HAS_SHADOW_CATCHER
  bool catches; /* nothing goes on: the sky is seen, as dark as the shadows of others make the surface */
#endif
};

float shading_mean(vec3 color)
{
  return (color.r + color.g + color.b) / 3.0;
}

/* Nothing goes on; `path` stands for rays that are not there. */
Scattered shading_nothing(Path path)
{
  Scattered scattered;
  scattered.reflects = false;
  scattered.reflected = path;
  scattered.refracts = false;
  scattered.refracted = path;
#ifdef HAS_SHADOW_CATCHER
  scattered.catches = false;
#endif
  return scattered;
}

/* Whether light that comes from the other side of a lit surface is to be seen. */
bool shading_lit_through(Lit lit)
{
#ifdef HAS_ROUGHNESS
  return gloss_transmission_is_rough(lit.material, lit.eta);
#else
  return false;
#endif
}

/* Whether lights add anything. */
bool shading_is_lit(Lit lit)
{
#ifdef HAS_ROUGHNESS
  if (gloss_mirror_is_rough(lit.material) || shading_lit_through(lit)) {
    return true;
  }
#endif
  return optics_largest(lit.diffuse) > 0.0 || optics_largest(lit.highlight) > 0.0;
}

/* What the light that reaches a lit surface from `direction` adds to the pixel; `cosine` is its to the surface's normal. */
vec3 shading_lit_by(Lit lit, vec3 radiance, vec3 direction, float cosine)
{
  vec3 share = lit.diffuse * max(cosine, 0.0);
#ifdef HAS_ROUGHNESS
  share += gloss_lit(lit.material, lit.eta, lit.normal, -lit.view, direction);
  if (cosine <= 0.0) {
    return radiance * share;
  }
#endif
  float alignment = max(dot(optics_mirror(lit.view, lit.normal), direction), 0.0);
  if (optics_largest(lit.highlight) > 0.0 && alignment > 0.0) {
    share += lit.highlight * pow(alignment, lit.shine);
  }
  return radiance * share;
}

/* Where a shadow ray starts. A light that stands behind the flat triangle but before the smooth surface it stands for is
 * looked at from the latter: the triangle itself would be in the way. */
vec3 shading_shadow_origin(Lit lit, vec3 direction)
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
Shadow shading_next_shadow(inout int index, Lit lit, inout vec3 radiance)
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
    if (cosine <= 0.0 && !shading_lit_through(lit)) {
      continue;
    }
    vec3 contribution = shading_lit_by(lit, arriving, direction, cosine);
    if (light.shadow < 0.5) {
      radiance += contribution;
      continue;
    }
    Ray ray = ray_make(shading_shadow_origin(lit, direction), direction, lit.shadow);
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
vec3 shading_arrived(Shadow shadow)
{
  vec3 light = shadow.contribution * shadow.tint;
#ifdef HAS_ABSORPTION
  light *= optics_absorb(medium_absorption(shadow.media), shadow.t_max);
#endif
  return light;
}

/* Take a shadow ray through the surface that it has hit; false when it ends there or what is left is not worth following. */
bool shading_pass(inout Shadow shadow, Hit hit)
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

/* What a shadow catcher leaves of the sky behind it: the light on it over the light there would be if nothing but catchers
 * cast shadows, whose own are in the footage already; the mean of the channels, 1 in those without light. It hides what
 * else is behind it, as the ground in the footage does. (As Cycles.) */
float shading_caught(vec3 lit, vec3 unshadowed)
{
  vec3 ratio = vec3(unshadowed.r > 0.0 ? lit.r / unshadowed.r : 1.0, unshadowed.g > 0.0 ? lit.g / unshadowed.g : 1.0,
                    unshadowed.b > 0.0 ? lit.b / unshadowed.b : 1.0);
  return min(shading_mean(ratio), 1.0);
}

/* The reflected ray. An interpolated normal may bend it into the surface: then it grazes. */
Ray shading_reflected(Surface surface, vec3 mirrored, vec3 face)
{
  float outside = dot(mirrored, face);
  if (outside <= 0.0) {
    mirrored = normalize(mirrored + (1e-3 - outside) * face);
  }
  return ray_make(ray_spawn(surface, mirrored), mirrored, RAY_GLOSSY);
}

/* The refracted ray, likewise kept beyond the surface. */
Ray shading_refracted(Surface surface, vec3 bent, vec3 face, int kind)
{
  float outside = dot(bent, face);
  if (outside >= 0.0) {
    bent = normalize(bent - (1e-3 + outside) * face);
  }
  return ray_make(ray_spawn(surface, bent), bent, kind);
}

/* The path on the other side of a surface that is not there for it. */
Path shading_beyond(Path path, Surface surface, float t)
{
  path.ray.origin = ray_spawn(surface, path.ray.direction);
  path.t_max -= t;
  return path;
}

/* Where a path meets a surface: what it gives off towards the eye is added to `radiance`, what is cut out of the picture taken
 * off `alpha`, `lit` is what the lights are to light, and the result what goes on. */
Scattered shading_scatter(inout Path path, Hit hit, inout vec3 radiance, inout float alpha, out Lit lit)
{
  vec3 incoming = path.ray.direction;
  Surface surface = bvh_surface(hit, path.ray);
  Material material = material_at(surface);
  bool entering = dot(incoming, surface.geometric_normal) < 0.0;
  vec3 normal = entering ? surface.shading_normal : -surface.shading_normal;
  vec3 face = entering ? surface.geometric_normal : -surface.geometric_normal;
  if (dot(normal, incoming) >= 0.0) { /* an interpolated normal that looks away: the surface's own is the truth */
    normal = face;
  }
  bool culled = false;
#ifdef HAS_CULLING
  culled = !entering && material.cull_back > 0.5;
#endif
  bool transmits = optics_largest(material.transmit) > 0.0;
  bool borders = transmits && material.bounds_body > 0.5 && !culled; /* on a medium; no opaque surface's back bounds a body */
#ifdef HAS_ABSORPTION
  /* A ray that leaves a body has been inside it, even if it was not seen entering: the eye was inside. */
  path.weight *= optics_absorb(borders && !entering ? material.absorption : medium_absorption(path.media), hit.t);
#endif
  Scattered scattered = shading_nothing(path);
#ifdef HAS_CULLING
  if (culled) {
    material_hide(material);
    scattered.refracts = true;
    scattered.refracted = shading_beyond(path, surface, hit.t);
  }
#endif

  ivec4 beyond = path.media;
  if (borders) {
    beyond = entering ? medium_enter(path.media, surface.material) : medium_leave(path.media, surface.material);
  }
  float eta = 1.0 / material.ior; /* a coat of clear varnish is on both sides */
  if (transmits) {
    eta = entering ? medium_ior(path.media) / material.ior : material.ior / medium_ior(beyond);
  }
#ifdef HAS_HOLDOUT
  if (path.ray.kind == RAY_CAMERA && !culled && (bvh_visibility(hit) & VISIBILITY_HOLDOUT) != 0) {
    material_hide(material);
    material.transmit *= eta == 1.0 ? 1.0 : 0.0;
    alpha -= shading_mean(path.weight * (1.0 - material.transmit));
  }
#endif
#ifdef HAS_SHADOW_CATCHER
  int visibility = bvh_visibility(hit) & (VISIBILITY_SHADOW_CATCHER + VISIBILITY_HOLDOUT);
  scattered.catches = path.ray.kind == RAY_CAMERA && !culled && visibility == VISIBILITY_SHADOW_CATCHER;
  if (scattered.catches) {
    material.glow = vec3(0.0);
  }
#endif
  radiance += path.weight * material.glow;

  float cos_i = min(-dot(normal, incoming), 1.0);
#ifdef HAS_ROUGHNESS
  gloss_give_back(material, cos_i);
#endif
  float cos_t;
  float fresnel = optics_fresnel(cos_i, eta, cos_t);
  bool total = transmits && cos_t == 0.0;
  vec3 mirror = material_mirror(material, cos_i, fresnel);
  vec3 through = total ? vec3(0.0) : material_through(material, fresnel);
  bool scatters = false; /* what goes through; facets that reflect totally are then those of the mirror alone */
#ifdef HAS_ROUGHNESS
  scatters = frame_sample >= 0.0 && gloss_transmission_is_rough(material, eta);
#endif
  if (total && material.fresnel < 0.5 && !scatters) {
    mirror += material.transmit;
  }
  vec3 mirrored = optics_mirror(incoming, normal);
  vec3 bent = optics_refract(incoming, normal, cos_i, cos_t, eta);
  vec3 diffuse = material.diffuse;
#ifdef HAS_ROUGHNESS
  if (gloss_mirror_is_rough(material)) {
    float mean = microfacet_mean_cosine(cos_i, material.roughness * material.roughness);
    fresnel = optics_fresnel(mean, eta, cos_t);
  }
  if (frame_sample >= 0.0) {
    /* The same facet for both: together they keep what comes in where they are as rough. Lights take numbers from 0 on. */
    vec2 u = sampling_2d(sampling_pixel(gl_FragCoord.xy), int(frame_sample), -path.depth);
    if (gloss_mirror_is_rough(material)) {
      mirrored = gloss_mirrored(material, eta, normal, incoming, u, mirror);
    }
    if (scatters) {
      bent = gloss_refracted(material, eta, normal, incoming, u, through);
    }
  }
  else {
    gloss_draw_sharp(material, mirror, diffuse);
  }
  lit.material = material;
  lit.material.reflect *= path.weight;
  lit.material.grazing *= path.weight;
  lit.material.transmit *= culled ? vec3(0.0) : path.weight;
  lit.eta = eta;
  lit.beyond = beyond;
#endif
  if (material.fresnel > 0.5) {
    diffuse *= 1.0 - fresnel * optics_largest(material.reflect);
  }
  lit.surface = surface;
  lit.normal = normal;
  lit.view = incoming;
  lit.diffuse = path.weight * diffuse;
  lit.highlight = path.weight * material.highlight;
  lit.shine = material.shine;
  lit.media = path.media;
  lit.shadow = RAY_SHADOW;
#ifdef HAS_LIGHT_SHAPES
  lit.depth = path.depth;
#endif

  bool goes_on = path.depth < int(frame_max_depth) && !culled;
#ifdef HAS_SHADOW_CATCHER
  if (scattered.catches) {
    goes_on = false;
    lit.diffuse = diffuse; /* whatever the path weighs, it is a ratio that is asked for */
    lit.highlight = material.highlight;
#ifdef HAS_ROUGHNESS
    lit.material = material;
#endif
  }
#endif
  mirror *= path.weight;
  through *= path.weight;
  if (goes_on) {
    scattered.reflects = optics_largest(mirror) > frame_weight_cutoff;
    scattered.refracts = optics_largest(through) > frame_weight_cutoff;
  }
  if (scattered.reflects) {
    Ray ray = shading_reflected(surface, mirrored, face);
    scattered.reflected = shading_path(ray, 1e30, mirror, path.depth + 1, path.media);
  }
  if (scattered.refracts && !culled) {
    int kind = eta == 1.0 ? path.ray.kind : RAY_TRANSMISSION;
    Ray ray = shading_refracted(surface, bent, face, kind);
    scattered.refracted = shading_path(ray, 1e30, through, path.depth + 1, beyond);
  }
  return scattered;
}
