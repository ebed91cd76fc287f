/* Blender's White Noise Texture: a color that looks random for each place, its red the value. */
#include "hash_lib.glsl"

vec3 white_noise_1d(float w)
{
  return vec3(hash_numbers(vec4(w)).x, hash_numbers(vec4(w), vec4(1.0, 2.0, 0.0, 0.0)).xy);
}

vec3 white_noise_2d(vec2 place)
{
  vec4 x = place.xxxx;
  vec4 y = place.yyyy;
  return vec3(hash_numbers(x, y).x, hash_numbers(x, y, vec4(1.0, 2.0, 0.0, 0.0)).xy);
}

vec3 white_noise_3d(vec3 place)
{
  vec4 x = place.xxxx;
  vec4 y = place.yyyy;
  vec4 z = place.zzzz;
  return vec3(hash_numbers(x, y, z).x, hash_numbers(x, y, z, vec4(1.0, 2.0, 0.0, 0.0)).xy);
}

vec3 white_noise_4d(vec3 place, float w)
{
  vec4 p = vec4(place, w);
  return hash_numbers(p.xzwx, p.yxzy, p.zwyz, p.wyxw).xyz;
}
