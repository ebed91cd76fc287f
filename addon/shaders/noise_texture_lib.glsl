/* Fractal noise as Blender's Noise Texture and the distortion of its waves have it: octaves of Perlin's gradient noise
 * (Perlin 2002, Improving Noise), summed as Musgrave does (Ebert et al., Texturing and Modeling).
 *
 * One function for each number of dimensions. Each evaluates its noise at one place only, in a loop over channels (what
 * distorts the place along each axis, the value, two more for the color) and octaves: drivers compile it once. */
#include "hash_lib.glsl"

#define NOISE_FBM 0
#define NOISE_MULTIFRACTAL 1
#define NOISE_HYBRID 2
#define NOISE_RIDGED 3
#define NOISE_HETERO 4

/* What the sum is made by, and where it stands. Channels below 0 distort, 0 is the value. */
struct Noise {
  vec4 origin; /* of the texture */
  vec4 moved; /* by the distortion, over its strength */
  vec4 place; /* of this channel */
  vec3 color;
  float detail, roughness, lacunarity, offset, gain, distortion;
  int type;
  bool normalized;
  float octaves, scale, amplitude; /* of this channel */
  float signal, sum, total, weight, value;
};

vec4 noise_faded(vec4 t)
{
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/* `x`, or -x where the top bit of `sign` is set. */
float noise_signed(float x, uint sign)
{
  return uintBitsToFloat(floatBitsToUint(x) ^ (sign & 0x80000000u));
}

/* The gradient that a corner's hash chooses, times the way from there. */
float noise_slope(uint hash, float x)
{
  return noise_signed(float(1u + (hash & 7u)), hash << 28) * x;
}

float noise_slope(uint hash, vec2 way)
{
  bool along = (hash & 4u) == 0u;
  return noise_signed(along ? way.x : way.y, hash << 31) + noise_signed(2.0 * (along ? way.y : way.x), hash << 30);
}

float noise_slope(uint hash, vec3 way)
{
  uint h = hash & 15u;
  float u = h < 8u ? way.x : way.y;
  float v = h < 4u ? way.y : ((h == 12u || h == 14u) ? way.x : way.z);
  return noise_signed(u, h << 31) + noise_signed(v, h << 30);
}

float noise_slope(uint hash, vec4 way)
{
  uint h = hash & 31u;
  float u = h < 24u ? way.x : way.y;
  float v = h < 16u ? way.y : way.z;
  float s = h < 8u ? way.z : way.w;
  return noise_signed(u, h << 31) + noise_signed(v, h << 30) + noise_signed(s, h << 29);
}

float noise_mixed(vec4 corners, float s, float t)
{
  vec2 pair = mix(corners.xz, corners.yw, s);
  return mix(pair.x, pair.y, t);
}

/* Perlin's noise in one to four dimensions, at most 1 or so either way. */
float noise_perlin(float p)
{
  float f = p - floor(p);
  uint cell = uint(int(floor(p)));
  uvec4 hash = hash_words(uvec4(cell, cell + 1u, 0u, 0u));
  return 0.25 * mix(noise_slope(hash.x, f), noise_slope(hash.y, f - 1.0), noise_faded(vec4(f)).x);
}

float noise_perlin(vec2 p)
{
  vec2 f = p - floor(p);
  vec2 g = f - 1.0;
  vec2 s = noise_faded(vec4(f, f)).xy;
  uvec2 a = uvec2(ivec2(floor(p)));
  uvec2 b = a + 1u;
  uvec4 hash = hash_words(uvec4(a.x, b.x, a.x, b.x), uvec4(a.y, a.y, b.y, b.y));
  vec2 low = vec2(noise_slope(hash.x, f), noise_slope(hash.y, vec2(g.x, f.y)));
  vec2 high = vec2(noise_slope(hash.z, vec2(f.x, g.y)), noise_slope(hash.w, g));
  return 0.6616 * noise_mixed(vec4(low, high), s.x, s.y);
}

/* The slopes at the corners of a side of a cell, `way` from the one at the origin. */
vec4 noise_side(uvec4 hash, vec3 way)
{
  vec2 g = way.yz - 1.0;
  vec2 low = vec2(noise_slope(hash.x, way), noise_slope(hash.y, vec3(way.x, g.x, way.z)));
  return vec4(low, noise_slope(hash.z, vec3(way.xy, g.y)), noise_slope(hash.w, vec3(way.x, g)));
}

vec4 noise_side(uvec4 hash, vec4 way)
{
  vec2 g = way.yz - 1.0;
  vec2 low = vec2(noise_slope(hash.x, way), noise_slope(hash.y, vec4(way.x, g.x, way.zw)));
  return vec4(low, noise_slope(hash.z, vec4(way.xy, g.y, way.w)), noise_slope(hash.w, vec4(way.x, g, way.w)));
}

float noise_perlin(vec3 p)
{
  vec3 f = p - floor(p);
  vec3 s = noise_faded(vec4(f, 0.0)).xyz;
  uvec3 a = uvec3(ivec3(floor(p)));
  uvec3 b = a + 1u;
  uvec4 y = uvec4(a.y, b.y, a.y, b.y);
  uvec4 z = uvec4(a.z, a.z, b.z, b.z);
  vec4 low = noise_side(hash_words(uvec4(a.x), y, z), f);
  vec4 high = noise_side(hash_words(uvec4(b.x), y, z), vec3(f.x - 1.0, f.yz));
  return 0.982 * noise_mixed(mix(low, high, s.x), s.y, s.z);
}

float noise_perlin(vec4 p)
{
  vec4 f = p - floor(p);
  vec4 s = noise_faded(f);
  uvec4 a = uvec4(ivec4(floor(p)));
  uvec4 y = uvec4(a.y, a.y + 1u, a.y, a.y + 1u);
  uvec4 z = uvec4(a.z, a.z, a.z + 1u, a.z + 1u);
  vec2 ends = vec2(0.0);
  for (int side = 0; side < 2; side++) {
    vec4 way = vec4(f.xyz, f.w - float(side));
    uvec4 w = uvec4(a.w + uint(side));
    vec4 low = noise_side(hash_words(uvec4(a.x), y, z, w), way);
    vec4 high = noise_side(hash_words(uvec4(a.x + 1u), y, z, w), vec4(way.x - 1.0, way.yzw));
    ends = vec2(ends.y, noise_mixed(mix(low, high, s.x), s.y, s.z));
  }
  return 0.8344 * mix(ends.x, ends.y, s.w);
}

/* Places repeat every 100000: beyond, floats hardly tell parts of a cell apart. Far out only middles of cells show. */
vec4 noise_place(Noise noise)
{
  vec4 p = noise.place * noise.scale;
  return p - 100000.0 * trunc(p / 100000.0) + 0.5 * step(vec4(1000000.0), abs(p));
}

Noise noise_begin(vec4 origin, float detail, float roughness, float lacunarity, float offset, float gain,
                  float distortion, int type, bool normalized)
{
  Noise noise;
  noise.origin = origin;
  noise.moved = vec4(0.0);
  noise.color = vec3(0.0);
  noise.detail = clamp(detail, 0.0, 15.0);
  noise.roughness = max(roughness, 0.0);
  noise.lacunarity = lacunarity;
  noise.offset = offset;
  noise.gain = gain;
  noise.distortion = distortion;
  noise.type = type;
  noise.normalized = normalized;
  return noise;
}

/* The first channel: nothing distorts at the strength 0. */
int noise_first(Noise noise, int dimensions)
{
  return noise.distortion != 0.0 ? -dimensions : 0;
}

/* Each channel but the value looks at another part of the noise. */
void noise_enter(inout Noise noise, int channel, int dimensions)
{
  float seed = float(channel > 0 ? channel + dimensions - 1 : channel + dimensions);
  vec4 axis = vec4(0.0, 1.0, 2.0, 3.0);
  vec4 elsewhere = 100.0 + 100.0 * (dimensions == 1 ? hash_numbers(vec4(seed)) : hash_numbers(vec4(seed), axis));
  noise.place = noise.origin + (channel == 0 ? vec4(0.0) : elsewhere);
  noise.place += channel < 0 ? vec4(0.0) : noise.distortion * noise.moved;
  noise.octaves = channel < 0 ? 0.0 : noise.detail;
  noise.scale = 1.0;
  noise.amplitude = 1.0;
  noise.sum = 0.0;
  noise.total = 0.0;
  noise.weight = 1.0;
  noise.value = noise.type == NOISE_MULTIFRACTAL ? 1.0 : 0.0;
}

/* One octave more; the last one counts by the digits of the detail behind the point. */
void noise_add(inout Noise noise, float octave, float signal)
{
  float share = min(noise.octaves - octave + 1.0, 1.0);
  noise.signal = signal;
  if (noise.type == NOISE_FBM) {
    noise.sum += noise.amplitude * signal;
    noise.total += noise.amplitude;
    noise.value = mix(noise.value, noise.normalized ? 0.5 * noise.sum / noise.total + 0.5 : noise.sum, share);
  }
  else if (noise.type == NOISE_MULTIFRACTAL) {
    noise.value *= share * noise.amplitude * signal + 1.0;
  }
  else if (noise.type == NOISE_HETERO) {
    noise.value += share * (signal + noise.offset) * noise.amplitude * (octave == 0.0 ? 1.0 : noise.value);
  }
  else if (noise.type == NOISE_HYBRID) {
    float weight = noise.weight > 0.001 ? min(noise.weight, 1.0) : 0.0;
    float added = (signal + noise.offset) * noise.amplitude;
    noise.value += share * weight * added;
    noise.weight = weight * noise.gain * added;
  }
  else { /* ridges have whole octaves only */
    float ridge = noise.offset - abs(signal);
    float added = ridge * ridge * noise.weight;
    noise.value += share < 1.0 ? 0.0 : added * noise.amplitude;
    noise.weight = clamp(added * noise.gain, 0.0, 1.0);
  }
  noise.scale *= noise.lacunarity;
  noise.amplitude *= noise.roughness;
}

void noise_leave(inout Noise noise, int channel, int dimensions)
{
  vec4 axis = vec4(equal(ivec4(channel + dimensions), ivec4(0, 1, 2, 3)));
  noise.moved += channel < 0 ? noise.signal * axis : vec4(0.0);
  noise.color += noise.value * vec3(equal(ivec3(channel), ivec3(0, 1, 2)));
}

/* The value and, with three `channels`, the color. Nothing is computed with none, as where all arguments are 0. */
float noise_texture_1d(float w, float scale, float detail, float roughness, float lacunarity, float offset, float gain,
                       float distortion, int type, bool normalized, int channels, out vec3 color)
{
  Noise noise = noise_begin(vec4(scale * w), detail, roughness, lacunarity, offset, gain, distortion, type, normalized);
  for (int channel = noise_first(noise, 1); channel < channels; channel++) {
    noise_enter(noise, channel, 1);
    for (float octave = 0.0; octave < noise.octaves + 1.0; octave++) {
      noise_add(noise, octave, noise_perlin(noise_place(noise).x));
    }
    noise_leave(noise, channel, 1);
  }
  color = noise.color;
  return color.x;
}

float noise_texture_2d(vec2 place, float scale, float detail, float roughness, float lacunarity, float offset,
                       float gain, float distortion, int type, bool normalized, int channels, out vec3 color)
{
  vec4 origin = vec4(scale * place, 0.0, 0.0);
  Noise noise = noise_begin(origin, detail, roughness, lacunarity, offset, gain, distortion, type, normalized);
  for (int channel = noise_first(noise, 2); channel < channels; channel++) {
    noise_enter(noise, channel, 2);
    for (float octave = 0.0; octave < noise.octaves + 1.0; octave++) {
      noise_add(noise, octave, noise_perlin(noise_place(noise).xy));
    }
    noise_leave(noise, channel, 2);
  }
  color = noise.color;
  return color.x;
}

float noise_texture_3d(vec3 place, float scale, float detail, float roughness, float lacunarity, float offset,
                       float gain, float distortion, int type, bool normalized, int channels, out vec3 color)
{
  vec4 origin = vec4(scale * place, 0.0);
  Noise noise = noise_begin(origin, detail, roughness, lacunarity, offset, gain, distortion, type, normalized);
  for (int channel = noise_first(noise, 3); channel < channels; channel++) {
    noise_enter(noise, channel, 3);
    for (float octave = 0.0; octave < noise.octaves + 1.0; octave++) {
      noise_add(noise, octave, noise_perlin(noise_place(noise).xyz));
    }
    noise_leave(noise, channel, 3);
  }
  color = noise.color;
  return color.x;
}

float noise_texture_4d(vec3 place, float w, float scale, float detail, float roughness, float lacunarity, float offset,
                       float gain, float distortion, int type, bool normalized, int channels, out vec3 color)
{
  vec4 origin = scale * vec4(place, w);
  Noise noise = noise_begin(origin, detail, roughness, lacunarity, offset, gain, distortion, type, normalized);
  for (int channel = noise_first(noise, 4); channel < channels; channel++) {
    noise_enter(noise, channel, 4);
    for (float octave = 0.0; octave < noise.octaves + 1.0; octave++) {
      noise_add(noise, octave, noise_perlin(noise_place(noise)));
    }
    noise_leave(noise, channel, 4);
  }
  color = noise.color;
  return color.x;
}
