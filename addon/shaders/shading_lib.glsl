/* What happens where a ray meets a surface: paper 2.4, step 2. Light that is given off, and the two rays that go on from
 * there. */
#include "shadow_lib.glsl"

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

/* What a shadow catcher leaves of the sky behind it: the light on it over the light there would be if nothing but catchers
 * cast shadows, whose own are in the footage already; the mean of the channels, 1 in those without light. It hides what
 * else is behind it, as the ground in the footage does. (As Cycles.) */
float shading_caught(vec3 lit, vec3 unshadowed)
{
  vec3 ratio = vec3(unshadowed.r > 0.0 ? lit.r / unshadowed.r : 1.0, unshadowed.g > 0.0 ? lit.g / unshadowed.g : 1.0,
                    unshadowed.b > 0.0 ? lit.b / unshadowed.b : 1.0);
  return min(optics_mean(ratio), 1.0);
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
    alpha -= optics_mean(path.weight * (1.0 - material.transmit));
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
