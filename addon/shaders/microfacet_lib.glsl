/* Rough surfaces: microfacets whose normals follow the GGX distribution (Walter et al. 2007) and hide each other as Smith has
 * it, height-correlated (Heitz 2014, Understanding the Masking-Shadowing Function). `alpha` is the square of Blender's
 * roughness. All vectors are unit and leave the surface, `normal` on the side of `view`.
 *
 * What lights give is in units of what a white diffuse surface that faces them would return. */
#include "optics_lib.glsl"
#include "sampling_lib.glsl"

/* D: area of the facets with this normal for each area of the surface and solid angle. The squared sine is that of the cross
 * product, which keeps its digits where 1 - cos^2 loses them. */
float microfacet_density(vec3 normal, vec3 facet, float alpha)
{
  float cosine = dot(normal, facet);
  vec3 across = cross(normal, facet);
  float stretched = alpha * alpha * cosine * cosine + dot(across, across);
  return 2.0 * alpha * alpha / (TWO_PI * stretched * stretched);
}

/* Smith's Lambda: the area of facets that are hidden for each area that is seen from a direction. */
float microfacet_hidden(float cosine, float alpha)
{
  float tangent_square = max(1.0 - cosine * cosine, 0.0) / max(cosine * cosine, 1e-12);
  return 0.5 * sqrt(1.0 + alpha * alpha * tangent_square) - 0.5;
}

/* Share of the facets seen from one side that are seen from the other too, G2 / G1: the weight of a direction that the
 * sampled facets send a ray to. Refraction takes the same, as Cycles does. */
float microfacet_weight(float cos_view, float cos_other, float alpha)
{
  float seen = 1.0 + microfacet_hidden(abs(cos_view), alpha);
  return seen / (seen + microfacet_hidden(abs(cos_other), alpha));
}

/* A normal out of those of the facets that `view` sees, as large as they appear: half a sphere seen from a direction shows a
 * cap of normals of even density (Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps). */
vec3 microfacet_sample(vec3 normal, vec3 view, float alpha, vec2 u)
{
  float height = dot(normal, view);
  vec3 towards = normalize(height * normal + alpha * (view - height * normal)); /* in the space where facets form a sphere */
  vec3 facet = towards + sampling_cone(normal, 1.0 + dot(normal, towards), u);
  float up = max(dot(normal, facet), 0.0);
  return normalize(up * normal + alpha * (facet - up * normal));
}

/* Light that facets mirror from `light` to `view`, but for their Fresnel reflectance; `facet` is their normal. */
float microfacet_mirrored(vec3 normal, vec3 view, vec3 light, float alpha, out vec3 facet)
{
  facet = normalize(view + light);
  float cos_view = dot(normal, view);
  float cos_light = dot(normal, light);
  float shadowed = 1.0 + microfacet_hidden(cos_view, alpha) + microfacet_hidden(cos_light, alpha);
  return TWO_PI * microfacet_density(normal, facet, alpha) / (8.0 * max(cos_view, 1e-6) * shadowed);
}

/* Light that facets refract from `light`, on the other side, to `view`, but for the share that they mirror; `eta` is the index
 * at `view` over the one at `light`. Radiance is not counted denser in the denser body, as nowhere here. 0 where no facet
 * refracts so; `facet` faces `view`. */
float microfacet_refracted(vec3 normal, vec3 view, vec3 light, float alpha, float eta, out vec3 facet)
{
  facet = eta * view + light; /* along the normal of what refracts one into the other, to the side of the higher index */
  facet = normalize(dot(normal, facet) < 0.0 ? -facet : facet);
  float cos_facet = dot(facet, view);
  float cos_light = dot(facet, light);
  float cos_view = dot(normal, view);
  if (cos_facet <= 0.0 || cos_light >= 0.0 || dot(normal, facet) <= 0.0) {
    return 0.0;
  }
  float shadowed = 1.0 + microfacet_hidden(cos_view, alpha) + microfacet_hidden(dot(normal, light), alpha);
  float spread = eta * cos_facet + cos_light;
  float jacobian = -cos_facet * cos_light / max(spread * spread, 1e-12);
  return 0.5 * TWO_PI * microfacet_density(normal, facet, alpha) * jacobian / (max(cos_view, 1e-6) * shadowed);
}

/* Share of the light that facets which reflect all of it mirror into each other: fits to the integrals, the first within
 * 0.035, 0.01 on the mean, the second, over all directions, within 0.002. */
float microfacet_lost(float cosine, float alpha)
{
  float c = clamp(cosine, 1e-4, 1.0);
  float a = alpha;
  float above = c * a * a * (0.1971 + 0.1783 * a - 0.4466 * c + 6.6506 * c * a);
  float below = c * c * c - 2.6826 * c * c * a + 3.1376 * c * a * a + 0.0899 * a * a * a + 8.0544 * c * c * a * a;
  return clamp(above / below, 0.0, 0.9);
}

float microfacet_mean_lost(float alpha)
{
  return alpha * alpha * (3.5757 - 1.1751 * alpha) / (1.0 + 2.9102 * alpha + 0.1531 * alpha * alpha);
}

/* What multiplies the light that leaves to give back what is lost so, the share `lost` and on the mean over all directions
 * `mean_lost`, where facets return `reflectance` of what meets them (Turquin 2019, Practical Multiple Scattering Compensation; its
 * colour after Kulla and Conty 2017; as Cycles). */
vec3 microfacet_given_back(vec3 reflectance, float lost, float mean_lost)
{
  vec3 again = reflectance * (1.0 - mean_lost) / (1.0 - min(reflectance, 1.0) * mean_lost);
  return 1.0 + again * (lost / (1.0 - lost));
}

/* Cosine at which a smooth surface has the reflectance that the facets have on the mean. A fit to the integral, for all
 * indices of refraction alike. */
float microfacet_mean_cosine(float cosine, float alpha)
{
  float bent = 1.92 * alpha / (1.0 + 2.91 * alpha);
  float turned = 0.252 * alpha / (1.0 + 1.11 * alpha);
  return (1.0 - turned) * cosine + bent * pow(max(1.0 - cosine, 0.0), 0.19 + 0.75 * pow(max(alpha, 1e-4), -0.73));
}
