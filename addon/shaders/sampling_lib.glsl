/* Points that fill a square evenly, sample by sample, and shapes made of them.
 *
 * Sobol's first two dimensions, samples shuffled and digits scrambled after Owen, anew for each pixel and
 * each use within it, by hashes: no tables, no loops (Burley 2020, Practical Hash-based Owen Scrambling; the hash of
 * scrambled digits is Vegdahl's). Any first 2^n samples of a pixel are stratified in every way that 2^n can be; those of
 * other pixels and of other uses are independent of them. */
#include "quadric_lib.glsl"

/* A number that looks random (Jarzynski and Olano 2020, Hash Functions for GPU Rendering: pcg). */
uint sampling_hash(uint x)
{
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

uvec2 sampling_reverse_bits(uvec2 x)
{
  x = ((x & 0x55555555u) << 1u) | ((x >> 1u) & 0x55555555u);
  x = ((x & 0x33333333u) << 2u) | ((x >> 2u) & 0x33333333u);
  x = ((x & 0x0f0f0f0fu) << 4u) | ((x >> 4u) & 0x0f0f0f0fu);
  x = ((x & 0x00ff00ffu) << 8u) | ((x >> 8u) & 0x00ff00ffu);
  return (x << 16u) | (x >> 16u);
}

/* Flips each bit or not, as the bits below it and the seed tell: Owen's scrambling of digits that stand in reverse. */
uvec2 sampling_scramble(uvec2 x, uvec2 seed)
{
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16u) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/* The digits, in reverse, of sample number `index` of Sobol's second dimension; those of the first are the bits of `index`.
 * Its matrix is Pascal's triangle modulo 2: digit i is the sum of the bits whose number has all bits of i. */
uint sampling_sobol(uint index)
{
  index ^= (index & 0xaaaaaaaau) >> 1u;
  index ^= (index & 0xccccccccu) >> 2u;
  index ^= (index & 0xf0f0f0f0u) >> 4u;
  index ^= (index & 0xff00ff00u) >> 8u;
  return index ^ (index >> 16u);
}

/* The seed of a pixel: that of one far away where the picture's is not 0. */
uint sampling_pixel(vec2 pixel)
{
  uint seed = uint(int(frame_seed));
  return sampling_hash(uint(pixel.x) + sampling_hash(uint(pixel.y) + seed * sampling_hash(seed)));
}

/* Sample number `index`, in [0, 1)^2, of the `dimension`th thing that is sampled in a pixel. */
vec2 sampling_2d(uint pixel, int index, int dimension)
{
  uint seed = sampling_hash(pixel ^ sampling_hash(uint(dimension)));
  uvec2 scrambling = uvec2(sampling_hash(seed ^ 1u), sampling_hash(seed ^ 2u));
  uvec2 number = sampling_reverse_bits(uvec2(uint(index)));
  uint shuffled = sampling_reverse_bits(sampling_scramble(number, uvec2(seed))).x;
  uvec2 digits = sampling_reverse_bits(sampling_scramble(uvec2(shuffled, sampling_sobol(shuffled)), scrambling));
  return vec2(digits >> 8u) * (1.0 / 16777216.0); /* as many digits as a float has */
}

/* Densities of directions that are not left to chance: of what only one way finds, and of rays that have but one way to go. */
#define SAMPLING_ALWAYS 1e18
#define SAMPLING_CERTAIN 1e30

/* How much a direction counts that comes of one way to choose directions where another may choose it as well: 0 to 1, in sum 1
 * over both ways. The densities may be rough guesses, if only they are the same from both sides (Veach and Guibas 1995, the
 * power heuristic). */
float sampling_weight(float density, float of_other)
{
  float ratio = of_other / max(density, 1e-18);
  return 1.0 / (1.0 + ratio * ratio);
}

/* A point of the unit disc, evenly. */
vec2 sampling_disc(vec2 u)
{
  float angle = TWO_PI * u.y;
  return sqrt(u.x) * vec2(cos(angle), sin(angle));
}

/* `local` in a frame whose third axis is the unit vector `axis` (Duff et al. 2017, Building an Orthonormal Basis). */
vec3 sampling_around(vec3 axis, vec3 local)
{
  float side = axis.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (side + axis.z);
  float b = axis.x * axis.y * a;
  vec3 across = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
  return local.x * across + local.y * vec3(b, side + axis.y * axis.y * a, -axis.y) + local.z * axis;
}

/* A unit vector evenly out of the cone about `axis` whose angle has the cosine 1 - `height`. */
vec3 sampling_cone(vec3 axis, float height, vec2 u)
{
  float below = height * u.x;
  float across = sqrt(max(below * (2.0 - below), 0.0));
  float angle = TWO_PI * u.y;
  return normalize(sampling_around(axis, vec3(across * cos(angle), across * sin(angle), 1.0 - below)));
}
