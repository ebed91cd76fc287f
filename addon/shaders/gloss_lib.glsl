/* Materials whose mirror, coat or transmission is rough: what they send on of the light of lamps, and rays out of their
 * lobes. */
#include "material_lib.glsl"
#include "microfacet_lib.glsl"

/* A surface of less roughness is smooth: alpha^2 = 5e-7, as in Cycles. */
#define GLOSS_SMOOTH 0.0266

bool gloss_mirror_is_rough(Material material)
{
  vec3 share = material.reflect;
#ifdef HAS_METALS
  share += material.metallic + material.grazing;
#endif
  return material.roughness > GLOSS_SMOOTH && optics_largest(share) > 0.0;
}

bool gloss_coat_is_rough(Material material)
{
#ifdef HAS_COAT
  return material.coat_roughness > GLOSS_SMOOTH && optics_largest(material.coat) > 0.0;
#else
  return false;
#endif
}

/* Where the index does not change facets bend nothing. */
bool gloss_transmission_is_rough(Material material, float eta)
{
  return material.transmit_roughness > GLOSS_SMOOTH && abs(eta - 1.0) > 1e-3 && optics_largest(material.transmit) > 0.0;
}

#ifdef HAS_GLASS_ENERGY
#include <glass_energy>
#define GLOSS_ENERGY_SIDE 16 /* of the table of `glass_energy` */

/* Share of the light on rough glass that leaves it after it has met one facet. */
float gloss_kept_by_glass(float cosine, float roughness, float eta)
{
  vec3 place = clamp(vec3(cosine, sqrt(abs((1.0 - eta) / (1.0 + eta))), roughness), 0.0, 1.0) * float(GLOSS_ENERGY_SIDE - 1);
  vec3 cell = min(floor(place), float(GLOSS_ENERGY_SIDE - 2));
  ivec3 number = ivec3(cell);
  int first = ((eta > 1.0 ? GLOSS_ENERGY_SIDE : 0) + number.z) * GLOSS_ENERGY_SIDE + number.y;
  first = first * GLOSS_ENERGY_SIDE + number.x;
  vec4 smoother = read_glass_energy(first).kept;
  vec4 rougher = read_glass_energy(first + GLOSS_ENERGY_SIDE * GLOSS_ENERGY_SIDE).kept;
  vec4 near = mix(smoother, rougher, place.z - cell.z);
  vec2 along = mix(near.xy, near.zw, place.y - cell.y);
  return mix(along.x, along.y, place.x - cell.x);
}
#endif

/* Let rough facets give back what they send to each other, all of it where `multiscatter` is 1. Returned is the share that the mirror
 * keeps of what falls on it. */
float gloss_give_back(inout Material material, float cosine, float eta)
{
  float mirror_kept = 1.0;
  vec3 mirror_factor = vec3(1.0);
  if (material.multiscatter <= 0.0) {
    return mirror_kept;
  }
  bool mirror_is_rough = gloss_mirror_is_rough(material);
  if (mirror_is_rough) {
    float alpha = material.roughness * material.roughness;
    float lost = microfacet_lost(cosine, alpha);
    float mean_lost = microfacet_mean_lost(alpha);
    float mean_fresnel = material.fresnel > 0.5 ? optics_fresnel_mean(material_mirror_eta(material, eta)) : 1.0;
    mirror_factor = microfacet_given_back(material.reflect * mean_fresnel, lost, mean_lost);
    mirror_kept = mix(1.0, (1.0 - lost) * optics_largest(mirror_factor), material.multiscatter);
#ifdef HAS_METALS
    vec3 mean = optics_metal_mean(material.metallic, material.grazing, material.edge);
    vec3 factor = mix(vec3(1.0), microfacet_given_back(mean, lost, mean_lost), material.multiscatter);
    material.metallic *= factor;
    material.grazing *= factor;
#endif
  }
#ifdef HAS_GLASS_ENERGY
  /* In a picture of one sample glass is drawn as smooth, which loses nothing. */
  if (frame_sample >= 0.0 && material.body > 0.0 && gloss_transmission_is_rough(material, eta)) {
    float lost = 1.0 - gloss_kept_by_glass(cosine, material.transmit_roughness, eta);
    float of_glass = min(material.body / max(optics_largest(material.reflect), 1e-6), 1.0);
    vec3 mean = mix(material.transmit, of_glass * material.reflect, optics_fresnel_mean(eta)) / material.body;
    vec3 factor = microfacet_given_back(mean, lost, lost);
    mirror_factor = mirror_is_rough ? mix(mirror_factor, factor, of_glass) : mirror_factor;
    material.transmit *= mix(vec3(1.0), factor, material.multiscatter);
  }
#endif
  material.reflect *= mix(vec3(1.0), mirror_factor, material.multiscatter);
  return mirror_kept;
}

#ifdef HAS_COAT
/* The share that the coat mirrors. */
vec3 gloss_coat(Material material, float cosine)
{
  float cos_t;
  return material.coat * optics_fresnel(cosine, 1.0 / material.coat_ior, cos_t);
}

/* Take off all that lies below the coat what that mirrors and absorbs (as Cycles). */
void gloss_lay_coat(inout Material material, float cosine)
{
  float mean = cosine;
  if (gloss_coat_is_rough(material)) {
    mean = microfacet_mean_cosine(cosine, material.coat_roughness * material.coat_roughness);
  }
  float cos_t;
  float weight = optics_largest(material.coat);
  float mirrored = weight * optics_fresnel(mean, 1.0 / material.coat_ior, cos_t);
  vec3 left = (1.0 - mirrored) * mix(vec3(1.0), pow(material.coat_tint, vec3(1.0 / max(cos_t, 1e-3))), weight);
  material.diffuse *= left;
  material.reflect *= left;
  material.transmit *= left;
  material.glow *= left;
  material.highlight *= left;
  material.body *= optics_largest(left);
#ifdef HAS_METALS
  material.metallic *= left;
  material.grazing *= left;
#endif
#ifdef HAS_TRANSLUCENT
  material.translucent *= left;
#endif
}
#endif

/* Density of the rays of a lobe in a direction of whose light it sends on `share`, but for Fresnel's; times 2 pi. */
float gloss_density(float share, float cos_view, float cos_other, float alpha)
{
  return 2.0 * share / microfacet_weight(cos_view, cos_other, alpha);
}

/* Whether rays go on in a denser body, where they reach no light straight away: directions chosen for lights are of no use. */
bool gloss_enters(float eta)
{
  return eta < 1.0;
}

/* What is sent to `view` of the light that comes from `light`, which may lie on the other side of the surface, as a share of
 * what a white diffuse surface facing it returns. `eta` is the index before the surface over the one beyond. Directions towards
 * the light are chosen as densely as `asked`; rays out of the lobes, of which the coat takes the part `of_coat`, find it too. */
vec3 gloss_lit(Material material, float eta, vec3 normal, vec3 view, vec3 light, float of_coat, float asked)
{
  vec3 facet;
  float cos_t;
  float cos_view = dot(normal, view);
  float cos_light = dot(normal, light);
  vec3 returned = vec3(0.0);
  if (cos_light > 0.0) {
    if (gloss_mirror_is_rough(material)) {
      float alpha = material.roughness * material.roughness;
      float share = microfacet_mirrored(normal, view, light, alpha, facet);
      float cosine = min(dot(view, facet), 1.0);
      float fresnel = optics_fresnel(cosine, material_mirror_eta(material, eta), cos_t);
      float drawn = (1.0 - of_coat) * gloss_density(share, cos_view, cos_light, alpha);
      returned += sampling_weight(asked, drawn) * share * material_mirror(material, cosine, fresnel);
    }
#ifdef HAS_COAT
    if (gloss_coat_is_rough(material)) {
      float alpha = material.coat_roughness * material.coat_roughness;
      float share = microfacet_mirrored(normal, view, light, alpha, facet);
      float drawn = of_coat * gloss_density(share, cos_view, cos_light, alpha);
      returned += sampling_weight(asked, drawn) * share * gloss_coat(material, min(dot(view, facet), 1.0));
    }
#endif
    return returned;
  }
  if (gloss_transmission_is_rough(material, eta)) {
    float alpha = material.transmit_roughness * material.transmit_roughness;
    float share = microfacet_refracted(normal, view, light, alpha, eta, facet);
    float fresnel = optics_fresnel(clamp(dot(view, facet), 0.0, 1.0), eta, cos_t);
    float drawn = gloss_density(share, cos_view, cos_light, alpha);
    float weight = gloss_enters(eta) && asked < SAMPLING_ALWAYS ? 0.0 : sampling_weight(asked, drawn);
    returned = weight * share * material_through(material, fresnel);
  }
  return returned;
}

/* A ray out of a rough lobe. */
struct Drawn {
  vec3 direction;
  vec3 share;      /* its weight, 0 where it ends in the surface */
  float density;   /* of the directions there, times 2 pi */
  float roughness; /* of the lobe */
};

/* A direction into which the rough mirrors reflect. Of two one is drawn, the coat with the probability `of_coat`. */
Drawn gloss_mirrored(Material material, float eta, vec3 normal, vec3 incoming, vec2 u, float of_coat)
{
  Drawn drawn;
  float roughness = material.roughness;
  float part = 1.0;
#ifdef HAS_COAT
  bool coated = u.x < of_coat;
  u.x = coated ? u.x / of_coat : (u.x - of_coat) / (1.0 - of_coat);
  roughness = coated ? material.coat_roughness : roughness;
  part = coated ? of_coat : 1.0 - of_coat;
#endif
  float alpha = roughness > GLOSS_SMOOTH ? roughness * roughness : 0.0;
  vec3 facet = microfacet_sample(normal, -incoming, alpha, u);
  float cosine = clamp(-dot(facet, incoming), 0.0, 1.0);
  drawn.direction = optics_mirror(incoming, facet);
  float cos_view = -dot(normal, incoming);
  float cos_out = dot(normal, drawn.direction);
  float cos_t;
  drawn.share = material_mirror(material, cosine, optics_fresnel(cosine, material_mirror_eta(material, eta), cos_t));
#ifdef HAS_COAT
  drawn.share = coated ? gloss_coat(material, cosine) : drawn.share;
#endif
  drawn.share *= cos_out > 0.0 ? microfacet_weight(cos_view, cos_out, alpha) / part : 0.0;
  drawn.density = SAMPLING_CERTAIN;
  drawn.roughness = roughness;
  if (alpha > 0.0) {
    float returned = microfacet_mirrored(normal, -incoming, drawn.direction, alpha, facet);
    drawn.density = part * gloss_density(returned, cos_view, cos_out, alpha);
  }
  return drawn;
}

/* The same of rough transmission. What a facet reflects totally is its mirror's. */
Drawn gloss_refracted(Material material, float eta, vec3 normal, vec3 incoming, vec2 u)
{
  Drawn drawn;
  drawn.roughness = material.transmit_roughness;
  float alpha = material.transmit_roughness * material.transmit_roughness;
  vec3 facet = microfacet_sample(normal, -incoming, alpha, u);
  float cosine = clamp(-dot(facet, incoming), 0.0, 1.0);
  float cos_t;
  drawn.share = material_through(material, optics_fresnel(cosine, eta, cos_t));
  drawn.direction = optics_refract(incoming, facet, cosine, cos_t, eta);
  float cos_view = -dot(normal, incoming);
  float cos_out = dot(normal, drawn.direction);
  drawn.share *= cos_t > 0.0 && cos_out < 0.0 ? microfacet_weight(cos_view, cos_out, alpha) : 0.0;
  drawn.density = SAMPLING_CERTAIN;
  if (!gloss_enters(eta)) {
    float returned = microfacet_refracted(normal, -incoming, drawn.direction, alpha, eta, facet);
    drawn.density = gloss_density(returned, cos_view, cos_out, alpha);
  }
  return drawn;
}

/* Rays out of rough lobes that bring little are followed now and then only, for all the others (Arvo and Kirk 1990, Particle
 * Transport and Image Synthesis: Russian roulette): the more likely the larger their part of what the surface returns and that of
 * the pixel, `part` times the drawn share or what the lobe has on the mean, about `expected`, if that is more; and the narrower the
 * lobe, since what is bright then is not found by rays to the lights as well. A power of 2, so that of 2^n samples as many are
 * followed everywhere. */
float gloss_chance(Drawn drawn, vec3 expected, vec3 part)
{
  float chance = 2.0 * optics_largest(part * max(expected, drawn.share)) / max(drawn.roughness, GLOSS_SMOOTH);
  return clamp(exp2(floor(log2(max(chance, 1e-6)) + 0.5)), frame_least_chance, 1.0);
}

#define GLOSS_BLOCK 8.0 /* pixels along a side */
#define GLOSS_NUMBERS 0x20000000 /* what is sampled of lights has smaller numbers */

/* The number that decides, from 0 to 1 and even over the samples. Pixels side by side have the same: processors work on them in
 * step, so that only what none of them follows is saved. */
float gloss_number(int depth)
{
  return sampling_2d(sampling_pixel(floor(PIXEL / GLOSS_BLOCK)), int(frame_sample), GLOSS_NUMBERS + depth).x;
}

/* How much of a rough mirror is drawn as a sharp one where a pixel has one sample and shall have no noise. */
float gloss_sharpness(float roughness)
{
  return 1.0 - smoothstep(0.1, 0.5, roughness);
}

/* What a rough mirror is drawn as there: the rougher, the less of it as a sharp mirror. Of a metal some becomes diffuse in
 * place of what it would mirror of other things than lamps; the rest is left to the lamps' highlights. */
void gloss_draw_sharp(inout Material material, inout vec3 mirror)
{
  float sharp = gloss_sharpness(material.roughness);
  float blunt = (1.0 - sharp) * material.roughness;
  mirror *= sharp;
  if (material.fresnel < 0.5) {
    material.diffuse += blunt * material.reflect;
    material.reflect *= 1.0 - blunt;
  }
#ifdef HAS_METALS
  material.diffuse += blunt * material.metallic;
  material.metallic *= 1.0 - blunt;
  material.grazing *= 1.0 - blunt;
#endif
}
