/* Interface i: a = (cosine of incidence, n_from / n_to, azimuth, length), b = (absorption, unused). */
#include "optics_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  float cos_i = value.a.x;
  float eta = value.a.y;
  vec3 direction = vec3(sqrt(1.0 - cos_i * cos_i) * vec2(cos(value.a.z), sin(value.a.z)), -cos_i);
  vec3 normal = vec3(0.0, 0.0, 1.0);
  float cos_t;
  float reflectance = optics_fresnel(cos_i, eta, cos_t);
  out_fresnel = vec4(reflectance, cos_t, optics_largest(value.b.xyz), 0.0);
  out_mirrored = vec4(optics_mirror(direction, normal), 0.0);
  out_refracted = vec4(optics_refract(direction, normal, cos_i, cos_t, eta), 0.0);
  out_absorbed = vec4(optics_absorb(value.b.xyz, value.a.w), 0.0);
}
