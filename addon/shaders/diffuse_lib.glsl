/* Rough diffuse surfaces after Oren and Nayar: the model of Fujii (2012, A tiny improvement of Oren-Nayar reflectance model),
 * whose facets give back what they reflect to each other (Portsmouth, Kutz and Hill 2025, EON: A practical energy-preserving
 * rough diffuse BRDF). As in Cycles from Blender 4.3 on. */
#include "optics_lib.glsl"

/* What Fujii's B is multiplied by to give the light that is returned from a direction. */
float diffuse_returned(float cosine)
{
  float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
  float angle = acos(clamp(cosine, 0.0, 1.0));
  float steep = cosine > 1e-3 ? (sine / cosine) * (1.0 - sine * sine * sine) : 1.5 * cosine;
  return (sine * (angle - sine * cosine) + 2.0 / 3.0 * (steep - sine)) * 0.31830989;
}

/* Fujii's A; B is the roughness times that. */
float diffuse_flat(float roughness)
{
  return 1.0 / (1.0 + roughness * 0.28779341); /* 1/2 - 2 / 3 pi */
}

/* Share of the light from a direction that facets which reflect all of it return without the help of others. */
float diffuse_once(float roughness, float cosine)
{
  return diffuse_flat(roughness) * (1.0 + roughness * diffuse_returned(cosine));
}

/* What multiplies what is lost from both directions to give what others return of it: of a color less than by the formula, but
 * that is how Cycles does it. */
vec3 diffuse_given_back(vec3 albedo, float roughness)
{
  float mean = diffuse_flat(roughness) * (1.0 + roughness * 0.072488212); /* 2/3 - 28 / 15 pi */
  float lost = max(1.0 - mean, 1e-6);
  albedo = min(albedo, 1.0);
  return albedo * albedo * (mean / lost) / (1.0 - albedo * lost);
}

/* What multiplies the diffuse share; `given_back` as `diffuse_given_back` says. */
vec3 diffuse_rough(float roughness, vec3 given_back, float cos_view, float cos_light, float cos_between)
{
  float s = cos_between - cos_view * cos_light;
  float bright = s > 0.0 ? s / max(max(cos_view, cos_light), 1e-6) : s;
  float lost = (1.0 - diffuse_once(roughness, cos_view)) * (1.0 - diffuse_once(roughness, cos_light));
  return diffuse_flat(roughness) * (1.0 + roughness * bright) + given_back * max(lost, 0.0);
}
