/* Gabor noise (Lagae et al. 2009, Procedural Noise using Sparse Gabor Convolution) as Blender's Gabor Texture has it:
 * eight waves scattered in each cell, of random sign (Tavernier et al. 2019), in Gaussian bells that a Hann window ends
 * at 1, summed as phasors (Tricard et al. 2019, Procedural Phasor Noise).
 *
 * Bounds of loops come from `impulses`, so that drivers leave them loops: 8, or 0 where there is no texture. */
#include "hash_lib.glsl"
#include "quadric_lib.glsl"

/* The phasor of a wave at a place relative to its center. */
vec2 gabor_wave(float square, float cycles, float random_sign)
{
  if (square >= 1.0) {
    return vec2(0.0);
  }
  float bell = exp(-0.5 * TWO_PI * square) * (0.5 + 0.5 * cos(0.5 * TWO_PI * square));
  float angle = TWO_PI * cycles;
  return (random_sign < 0.5 ? -bell : bell) * vec2(cos(angle), sin(angle));
}

/* What the node shows of a sum of phasors, of which six standard deviations become 1. */
float gabor_shown(vec2 phasor, float deviation, out float phase, out float intensity)
{
  intensity = length(phasor) / (6.0 * deviation);
  phase = intensity > 0.0 ? atan(phasor.y, phasor.x) / TWO_PI + 0.5 : 0.5;
  return 0.5 + 0.5 * phasor.y / (6.0 * deviation);
}

float gabor_texture_2d(vec2 place, float scale, float frequency, float anisotropy, float orientation, int impulses,
                       out float phase, out float intensity)
{
  vec2 cell = floor(place * scale);
  vec2 local = place * scale - cell;
  float isotropy = 1.0 - clamp(anisotropy, 0.0, 1.0);
  vec2 offset = vec2(-1.0);
  vec2 sum = vec2(0.0);
  for (int turn = 0; turn < 9 * min(impulses, 1); turn++) {
    vec2 c = cell + offset;
    for (int i = 0; i < impulses; i++) {
      float seed = 3.0 * float(i);
      vec4 random = hash_numbers(vec4(c.xxx, seed + 1.0), vec4(c.yyy, c.x), vec4(seed, seed + 1.0, seed + 2.0, c.y));
      float angle = orientation + (random.x - 0.5) * 0.5 * TWO_PI * isotropy;
      vec2 way = local - offset - random.yw;
      float cycles = max(frequency, 0.001) * dot(way, vec2(cos(angle), sin(angle)));
      sum += gabor_wave(dot(way, way), cycles, random.z);
    }
    offset.x += 1.0;
    offset = offset.x > 1.0 ? vec2(-1.0, offset.y + 1.0) : offset;
  }
  return gabor_shown(sum, 1.0, phase, intensity);
}

float gabor_texture_3d(vec3 place, float scale, float frequency, float anisotropy, vec3 orientation, int impulses,
                       out float phase, out float intensity)
{
  vec3 cell = floor(place * scale);
  vec3 local = place * scale - cell;
  float isotropy = 1.0 - clamp(anisotropy, 0.0, 1.0);
  float across = length(orientation.xy);
  float inclination = atan(across, orientation.z);
  float azimuth = across > 0.0 ? atan(orientation.y, orientation.x) : 0.0;
  vec3 offset = vec3(-1.0);
  vec2 sum = vec2(0.0);
  for (int turn = 0; turn < 27 * min(impulses, 1); turn++) {
    vec3 c = cell + offset;
    for (int i = 0; i < impulses; i++) {
      vec3 seed = 3.0 * float(i) + vec3(0.0, 1.0, 2.0);
      vec4 third = vec4(c.z, seed.y, c.yz);
      vec4 center = hash_numbers(vec4(c.xz, seed.y, c.x), c.yxzy, third, vec4(seed.y, c.yx, seed.z));
      vec2 random = hash_numbers(c.xzxx, c.yxxx, vec4(c.z, seed.xxx), vec4(seed.x, c.yyy)).xy;
      vec2 angles = vec2(inclination, azimuth) + 0.5 * TWO_PI * isotropy * random;
      vec3 direction = vec3(sin(angles.x) * vec2(cos(angles.y), sin(angles.y)), cos(angles.x));
      vec3 way = local - offset - center.xyz;
      sum += gabor_wave(dot(way, way), max(frequency, 0.001) * dot(way, direction), center.w);
    }
    offset.x += 1.0;
    offset = offset.x > 1.0 ? vec3(-1.0, offset.y + 1.0, offset.z) : offset;
    offset = offset.y > 1.0 ? vec3(-1.0, -1.0, offset.z + 1.0) : offset;
  }
  return gabor_shown(sum, 0.84089642, phase, intensity);
}
