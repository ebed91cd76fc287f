/* Materials whose mirror or transmission is rough: what they send on of the light of lamps, and rays out of their lobes. */
#include "material_lib.glsl"
#include "microfacet_lib.glsl"

/* A surface of less roughness is smooth: alpha^2 = 5e-7, as in Cycles. */
#define GLOSS_SMOOTH 0.0266

bool gloss_mirror_is_rough(Material material)
{
  return material.roughness > GLOSS_SMOOTH && optics_largest(material.reflect + material.grazing) > 0.0;
}

/* Where the index does not change facets bend nothing. */
bool gloss_transmission_is_rough(Material material, float eta)
{
  return material.transmit_roughness > GLOSS_SMOOTH && abs(eta - 1.0) > 1e-3 && optics_largest(material.transmit) > 0.0;
}

/* What is sent to `view` of the light that comes from `light`, which may lie on the other side of the surface, as a share of
 * what a white diffuse surface facing it returns. `eta` is the index before the surface over the one beyond. */
vec3 gloss_lit(Material material, float eta, vec3 normal, vec3 view, vec3 light)
{
  vec3 facet;
  float cos_t;
  if (dot(normal, light) > 0.0) {
    if (!gloss_mirror_is_rough(material)) {
      return vec3(0.0);
    }
    float share = microfacet_mirrored(normal, view, light, material.roughness * material.roughness, facet);
    float cosine = min(dot(view, facet), 1.0);
    return share * material_mirror(material, cosine, optics_fresnel(cosine, eta, cos_t));
  }
  if (!gloss_transmission_is_rough(material, eta)) {
    return vec3(0.0);
  }
  float alpha = material.transmit_roughness * material.transmit_roughness;
  float share = microfacet_refracted(normal, view, light, alpha, eta, facet);
  float fresnel = optics_fresnel(clamp(dot(view, facet), 0.0, 1.0), eta, cos_t);
  return share * material_through(material, fresnel);
}

/* A direction into which the rough mirror reflects; `share` is its weight, 0 where it ends in the surface. */
vec3 gloss_mirrored(Material material, float eta, vec3 normal, vec3 incoming, vec2 u, out vec3 share)
{
  float alpha = material.roughness * material.roughness;
  vec3 facet = microfacet_sample(normal, -incoming, alpha, u);
  float cosine = clamp(-dot(facet, incoming), 0.0, 1.0);
  vec3 mirrored = optics_mirror(incoming, facet);
  float cos_out = dot(normal, mirrored);
  float cos_t;
  share = material_mirror(material, cosine, optics_fresnel(cosine, eta, cos_t));
  share *= cos_out > 0.0 ? microfacet_weight(dot(normal, incoming), cos_out, alpha) : 0.0;
  return mirrored;
}

/* The same of rough transmission. What a facet reflects totally is its mirror's. */
vec3 gloss_refracted(Material material, float eta, vec3 normal, vec3 incoming, vec2 u, out vec3 share)
{
  float alpha = material.transmit_roughness * material.transmit_roughness;
  vec3 facet = microfacet_sample(normal, -incoming, alpha, u);
  float cosine = clamp(-dot(facet, incoming), 0.0, 1.0);
  float cos_t;
  share = material_through(material, optics_fresnel(cosine, eta, cos_t));
  vec3 bent = optics_refract(incoming, facet, cosine, cos_t, eta);
  float cos_out = dot(normal, bent);
  share *= cos_t > 0.0 && cos_out < 0.0 ? microfacet_weight(dot(normal, incoming), cos_out, alpha) : 0.0;
  return bent;
}

/* Share of a mirror that one ray can stand for. */
float gloss_sharpness(float roughness)
{
  return 1.0 - smoothstep(0.1, 0.5, roughness);
}

/* Share of the light of a rough metal that is drawn as diffuse where a pixel has one sample, in place of what it would mirror
 * of other things than lamps: the rougher the more. What is left is mirrored, sharp. */
float gloss_blunt(Material material)
{
  return material.fresnel > 0.5 ? 0.0 : (1.0 - gloss_sharpness(material.roughness)) * material.roughness;
}
