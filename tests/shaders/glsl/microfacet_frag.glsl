/* Facets of alpha a.x seen from (a.y, azimuth a.z), numbers a.w and b.x; light from b.yzw, its side by the sign of z; the
 * index at the viewer over that beyond is TEST_ETA. */
#include "microfacet_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  float alpha = value.a.x;
  vec3 normal = vec3(0.0, 0.6, 0.8);
  float sine = sqrt(1.0 - value.a.y * value.a.y);
  vec3 view = sampling_around(normal, vec3(sine * cos(value.a.z), sine * sin(value.a.z), value.a.y));
  vec3 light = sampling_around(normal, value.b.yzw);
  vec3 facet = microfacet_sample(normal, view, alpha, vec2(value.a.w, value.b.x));
  vec3 between;
  vec3 across;
  float mirrored = microfacet_mirrored(normal, view, light, alpha, between);
  float refracted = microfacet_refracted(normal, view, light, alpha, TEST_ETA, across);
  /* All in the frame of the normal. */
  vec3 x = sampling_around(normal, vec3(1.0, 0.0, 0.0));
  vec3 y = sampling_around(normal, vec3(0.0, 1.0, 0.0));
  out_facet = vec4(dot(x, facet), dot(y, facet), dot(normal, facet), microfacet_density(normal, facet, alpha));
  out_light = vec4(mirrored, refracted, microfacet_weight(value.a.y, value.b.w, alpha), dot(across, view));
  out_mean = vec4(microfacet_mean_cosine(value.a.y, alpha), microfacet_density(normal, light, alpha),
                  microfacet_lost(value.a.y, alpha), microfacet_mean_lost(alpha));
}
