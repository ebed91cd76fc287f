/* What happens where a ray meets a surface: paper 2.4, step 2. Light that is given off, and the two rays that go on from
 * there. */
#include "shadow_lib.glsl"
#include "path_lib.glsl"
#ifdef HAS_SEEN_LAMPS
#include "lamp_lib.glsl"
#endif

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

#ifdef HAS_NORMALS
/* A unit normal as mirrors have it: one that `incoming` looks at, and by which it is mirrored off the surface. The reflected ray is
 * lifted over it where it is not, and the normal is the one that mirrors it so. */
vec3 shading_bent_normal(vec3 normal, vec3 incoming, vec3 face)
{
  vec3 mirrored = optics_mirror(incoming, normal);
  float height = -dot(incoming, face);
  float lacking = min(0.9 * height, 0.01) - dot(mirrored, face);
  return lacking > 0.0 ? normalize(normalize(mirrored + lacking * face) - incoming) : normal;
}
#endif

/* Density of a path that passes a surface straight. Where shadow rays do not pass, what is behind is found by the path alone. */
float shading_density_passed(float density, bool shadows_pass)
{
  return shadows_pass || density == 0.0 ? density : SAMPLING_CERTAIN;
}

/* The path on the other side of a surface that is not there for it. */
Path shading_beyond(Path path, Surface surface, float t)
{
  path.ray.origin = ray_spawn(surface, path.ray.direction);
  path.t_max -= t;
  path.length_before += t;
  path.density = shading_density_passed(path.density, false);
  return path;
}

#ifdef HAS_SEEN_LAMPS
/* What a path sees of lamps before it meets a surface after `t_max`, or nothing. */
vec3 shading_lamps(Path path, float t_max, bool missed)
{
  vec3 seen = vec3(0.0);
  int count = int(frame_seen_lamp_count);
  for (int index = 0; index < count; index++) {
    Light light = read_light(index);
    LightShape shape = read_light_shape(index);
    float range;
    vec3 radiance = lamp_radiance(light, shape, path.ray, range);
    bool is_sun = light.kind == LIGHT_SUN;
    bool sees = (light.visibility & path.ray.kind) != 0 && range > 0.0 && (is_sun ? missed : range < t_max);
#ifdef HAS_LIGHT_LINKING
    /* Linked to some objects: a mirror does not know whether to them. */
    sees = sees && (path.ray.kind == RAY_CAMERA || light.receivers + light.blockers == 0);
#endif
    if (sees) {
      float asked = light_density(is_sun ? 1.0 : path.length_before + range, shape.seen_area);
      radiance *= sampling_weight(path.density, asked);
#ifdef HAS_ABSORPTION
      radiance *= optics_absorb(medium_absorption(path.media), range);
#endif
      seen += radiance;
    }
  }
  return path.weight * seen;
}
#endif

/* What a surface gives off towards a path that meets it after `t`. As a light it may have been asked before. */
vec3 shading_glow(Path path, Material material, float t)
{
  vec3 glow = path.weight * material.glow;
#ifdef HAS_EMITTERS
  if (frame_sample >= 0.0) {
    glow *= sampling_weight(path.density, light_density(path.length_before + t, material.glow_area));
  }
#endif
  return glow;
}

/* Where a path meets a surface: what it gives off towards the eye is added to `radiance`, what is cut out of the picture taken
 * off `alpha`, `lit` is what the lights are to light, and the result what goes on. */
Scattered shading_scatter(inout Path path, Hit hit, Surface surface, Material material, inout vec3 radiance,
                          inout float alpha, out Lit lit)
{
  vec3 incoming = path.ray.direction;
  bool entering = dot(incoming, surface.geometric_normal) < 0.0;
  vec3 normal = entering ? surface.shading_normal : -surface.shading_normal;
  vec3 face = entering ? surface.geometric_normal : -surface.geometric_normal;
  if (dot(normal, incoming) >= 0.0) { /* an interpolated normal that looks away: the surface's own is the truth */
    normal = face;
  }
#ifdef HAS_NORMALS
  lit.smooth_normal = normal;
  vec3 told = normal;
  if (optics_largest(abs(material.normal)) > 0.0) {
    told = normalize(material.normal);
    normal = shading_bent_normal(told, incoming, face);
  }
  lit.mirror_normal = normal;
#endif
  bool culled = false;
#ifdef HAS_CULLING
  culled = !entering && material.cull_back > 0.5;
#endif
#ifndef HAS_TRANSMISSION
  material.transmit = vec3(0.0); /* none has any: what follows from it falls away */
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
#ifdef HAS_HOLDOUT_SHARE
    material.holdout = 0.0;
#endif
  }
#endif
#ifdef HAS_HOLDOUT_SHARE
  if (path.ray.kind == RAY_CAMERA && !culled) {
    alpha -= optics_mean(path.weight) * material.holdout;
  }
#endif
#ifdef HAS_SHADOW_CATCHER
  int visibility = bvh_visibility(hit) & (VISIBILITY_SHADOW_CATCHER + VISIBILITY_HOLDOUT);
  scattered.catches = path.ray.kind == RAY_CAMERA && !culled && visibility == VISIBILITY_SHADOW_CATCHER;
  if (scattered.catches) {
    material.glow = vec3(0.0);
  }
#endif
  float cos_i = min(-dot(normal, incoming), 1.0);
  float cos_t;
#ifdef HAS_COAT
  vec3 coat = gloss_coat(material, cos_i);
  gloss_lay_coat(material, cos_i);
#endif
  radiance += shading_glow(path, material, hit.t);
#ifdef HAS_ROUGHNESS
  float mirror_kept = gloss_give_back(material, cos_i, eta);
#endif
  float mirror_eta = material_mirror_eta(material, eta);
  float fresnel = optics_fresnel(cos_i, mirror_eta, cos_t);
  vec3 mirror = material_mirror(material, cos_i, fresnel);
  vec3 through = material_through(material, optics_fresnel(cos_i, eta, cos_t));
  bool total = transmits && cos_t == 0.0;
  bool scatters = false; /* what goes through; facets that reflect totally are then those of the mirror alone */
#ifdef HAS_ROUGHNESS
  scatters = frame_sample >= 0.0 && gloss_transmission_is_rough(material, eta);
#endif
  if (total) {
    mirror += scatters ? vec3(0.0) : through;
    through = vec3(0.0);
  }
  vec3 mirrored = optics_mirror(incoming, normal);
  vec3 bent = optics_refract(incoming, normal, cos_i, cos_t, eta);
#ifdef HAS_ROUGHNESS
  if (gloss_mirror_is_rough(material)) {
    float mean = microfacet_mean_cosine(cos_i, material.roughness * material.roughness);
    fresnel = mirror_kept * optics_fresnel(mean, mirror_eta, cos_t);
  }
#endif
  material.diffuse *= 1.0 - fresnel * material.diffuse_covered;
#ifdef HAS_TRANSLUCENT
  material.translucent *= 1.0 - fresnel * material.diffuse_covered;
#endif
#ifdef HAS_ROUGHNESS
  bool mirror_is_rough = gloss_mirror_is_rough(material);
  float of_coat = 0.0;
  float density_mirrored = SAMPLING_CERTAIN;
  float density_bent = SAMPLING_CERTAIN;
  float chance_mirrored = 1.0;
  float chance_bent = 1.0;
#ifdef HAS_COAT
  mirror_is_rough = mirror_is_rough || gloss_coat_is_rough(material);
  of_coat = optics_mean(coat) / max(optics_mean(coat + mirror), 1e-30);
#endif
  if (frame_sample >= 0.0) {
    vec3 returned = material.diffuse + mirror + through;
#ifdef HAS_TRANSLUCENT
    returned += material.translucent;
#endif
#ifdef HAS_COAT
    returned += coat;
#endif
    vec3 part = path.weight / max(optics_largest(returned), 1e-6);
    /* The same facet for both: together they keep what comes in where they are as rough. Lights take numbers from 0 on. */
    vec2 u = sampling_2d(sampling_pixel(PIXEL), int(frame_sample), -path.depth);
    if (mirror_is_rough) {
      Drawn drawn = gloss_mirrored(material, eta, normal, incoming, u, of_coat);
      mirrored = drawn.direction;
      chance_mirrored = gloss_chance(drawn, mirror, part);
      mirror = drawn.share;
      density_mirrored = drawn.density;
    }
#ifdef HAS_COAT
    else {
      mirror += coat;
    }
#endif
    if (scatters) {
      Drawn drawn = gloss_refracted(material, eta, normal, incoming, u);
      bent = drawn.direction;
      chance_bent = gloss_chance(drawn, through, part);
      through = drawn.share;
      density_bent = drawn.density;
    }
  }
  else {
    gloss_draw_sharp(material, mirror);
    density_mirrored = mirror_is_rough ? 0.0 : SAMPLING_CERTAIN;
    density_bent = gloss_transmission_is_rough(material, eta) ? 0.0 : SAMPLING_CERTAIN;
#ifdef HAS_COAT
    mirror += coat * gloss_sharpness(material.coat_roughness);
#endif
  }
  lit.material = material;
  lit.material.reflect *= path.weight;
#ifdef HAS_METALS
  lit.material.metallic *= path.weight;
  lit.material.grazing *= path.weight;
#endif
#ifdef HAS_COAT
  lit.material.coat *= path.weight;
#endif
  lit.material.transmit *= culled ? vec3(0.0) : path.weight;
  lit.eta = eta;
  lit.beyond = beyond;
  lit.of_coat = of_coat;
#endif
  lit.surface = surface;
#ifdef HAS_NORMALS
  lit.normal = told;
#else
  lit.normal = normal;
#endif
  lit.view = incoming;
  lit.diffuse = path.weight * material.diffuse;
  lit.highlight = path.weight * material.highlight;
  lit.shine = material.shine;
  lit.media = path.media;
  lit.shadow = RAY_SHADOW;
  lit.depth = path.depth;
#ifdef HAS_LIGHT_PATH
  lit.passed = path.passed;
#endif
#ifdef HAS_LIGHT_LINKING
  lit.visibility = bvh_visibility(hit);
#endif
#ifdef HAS_TRANSLUCENT
  lit.translucent = path.weight * material.translucent;
#endif
#ifdef HAS_DIFFUSE_ROUGHNESS
  lit.diffuse_roughness = material.diffuse_roughness;
  lit.given_back = diffuse_given_back(material.diffuse, material.diffuse_roughness);
#endif

  bool goes_on = path.depth < int(frame_max_depth) && !culled;
#ifdef HAS_SHADOW_CATCHER
  if (scattered.catches) {
    goes_on = false;
    lit.diffuse = material.diffuse; /* whatever the path weighs, it is a ratio that is asked for */
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
#ifdef HAS_ROUGHNESS
  float number = gloss_number(path.depth);
  scattered.reflects = scattered.reflects && number < chance_mirrored;
  scattered.refracts = scattered.refracts && number < chance_bent;
  mirror /= chance_mirrored;
  through /= chance_bent;
#endif
  if (scattered.reflects) {
    Ray ray = shading_reflected(surface, mirrored, face);
    scattered.reflected = path_make(ray, 1e30, mirror, path.depth + 1, path.media);
#ifdef HAS_ROUGHNESS
    scattered.reflected.density = density_mirrored;
#endif
#ifdef HAS_LIGHT_PATH
    scattered.reflected.passed = path.passed;
#endif
  }
  if (scattered.refracts && !culled) {
    int kind = eta == 1.0 ? path.ray.kind : RAY_TRANSMISSION;
    Ray ray = shading_refracted(surface, bent, face, kind);
    bool straight = eta == 1.0;
    scattered.refracted = path_make(ray, 1e30, through, path.depth + 1, beyond);
    scattered.refracted.length_before = straight ? path.length_before + hit.t : 0.0;
#ifdef HAS_ROUGHNESS
    bool shadows_pass = optics_largest(shadow_passed(material)) > 0.0;
    float density_straight = shading_density_passed(path.density, shadows_pass);
    scattered.refracted.density = straight ? density_straight : density_bent;
#endif
#ifdef HAS_LIGHT_PATH
    scattered.refracted.passed = path.passed + (straight ? 1 : 0);
#endif
  }
  return scattered;
}
