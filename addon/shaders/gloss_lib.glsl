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

/* Let the rough facets of a mirror or metal give back what they reflect to each other. */
void gloss_give_back(inout Material material, float cosine)
{
  if (material.multiscatter > 0.5 && material.fresnel < 0.5 && gloss_mirror_is_rough(material)) {
    vec3 mean = material.reflect;
#ifdef HAS_METALS
    mean = optics_metal_mean(material.reflect, material.grazing, material.edge);
#endif
    vec3 factor = microfacet_given_back(mean, cosine, material.roughness * material.roughness);
    material.reflect *= factor;
    material.grazing *= factor;
  }
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

/* What a rough mirror is drawn as where a pixel has one sample and shall have no noise: the rougher, the less of it as a
 * sharp mirror. Of a metal some becomes diffuse in place of what it would mirror of other things than lamps; the rest is
 * left to the lamps' highlights. */
void gloss_draw_sharp(inout Material material, inout vec3 mirror, inout vec3 diffuse)
{
  float sharp = 1.0 - smoothstep(0.1, 0.5, material.roughness);
  float blunt = material.fresnel > 0.5 ? 0.0 : (1.0 - sharp) * material.roughness;
  mirror *= sharp;
  diffuse += blunt * material.reflect;
  material.reflect *= 1.0 - blunt;
  material.grazing *= 1.0 - blunt;
}
