/* Hashes with the results that Blender's textures have: lookup3 (Jenkins 2006) of one to four words, four at a time,
 * and PCG of two to four whole numbers (Jarzynski and Olano 2020, Hash Functions for GPU Rendering). */

uvec4 hash_rotated(uvec4 x, uint bits)
{
  return (x << bits) | (x >> (32u - bits));
}

/* lookup3: the last words are in; stirs until every bit of them is in all bits. */
uvec4 hash_final(uvec4 a, uvec4 b, uvec4 c)
{
  c = (c ^ b) - hash_rotated(b, 14u);
  a = (a ^ c) - hash_rotated(c, 11u);
  b = (b ^ a) - hash_rotated(a, 25u);
  c = (c ^ b) - hash_rotated(b, 16u);
  a = (a ^ c) - hash_rotated(c, 4u);
  b = (b ^ a) - hash_rotated(a, 14u);
  return (c ^ b) - hash_rotated(b, 24u);
}

/* lookup3 starts with a constant that counts the bytes. */
uvec4 hash_words(uvec4 x)
{
  uvec4 start = uvec4(0xdeadbeefu + 4u + 13u);
  return hash_final(start + x, start, start);
}

uvec4 hash_words(uvec4 x, uvec4 y)
{
  uvec4 start = uvec4(0xdeadbeefu + 8u + 13u);
  return hash_final(start + x, start + y, start);
}

uvec4 hash_words(uvec4 x, uvec4 y, uvec4 z)
{
  uvec4 start = uvec4(0xdeadbeefu + 12u + 13u);
  return hash_final(start + x, start + y, start + z);
}

uvec4 hash_words(uvec4 x, uvec4 y, uvec4 z, uvec4 w)
{
  uvec4 start = uvec4(0xdeadbeefu + 16u + 13u);
  uvec4 a = start + x;
  uvec4 b = start + y;
  uvec4 c = start + z;
  a = (a - c) ^ hash_rotated(c, 4u);
  c += b;
  b = (b - a) ^ hash_rotated(a, 6u);
  a += c;
  c = (c - b) ^ hash_rotated(b, 8u);
  b += a;
  a = (a - c) ^ hash_rotated(c, 16u);
  c += b;
  b = (b - a) ^ hash_rotated(a, 19u);
  a += c;
  c = (c - b) ^ hash_rotated(b, 4u);
  b += a;
  return hash_final(a + w, b, c);
}

/* Hashes as numbers from 0 to 1. */
vec4 hash_fractions(uvec4 hash)
{
  return vec4(hash) * (1.0 / 4294967296.0);
}

/* Numbers from 0 to 1 out of the bits of one to four numbers, four at a time. */
vec4 hash_numbers(vec4 x)
{
  return hash_fractions(hash_words(floatBitsToUint(x)));
}

vec4 hash_numbers(vec4 x, vec4 y)
{
  return hash_fractions(hash_words(floatBitsToUint(x), floatBitsToUint(y)));
}

vec4 hash_numbers(vec4 x, vec4 y, vec4 z)
{
  return hash_fractions(hash_words(floatBitsToUint(x), floatBitsToUint(y), floatBitsToUint(z)));
}

vec4 hash_numbers(vec4 x, vec4 y, vec4 z, vec4 w)
{
  uvec4 first = floatBitsToUint(x);
  return hash_fractions(hash_words(first, floatBitsToUint(y), floatBitsToUint(z), floatBitsToUint(w)));
}

/* PCG of two to four whole numbers, from 0 to 1. Blender shifts with the sign and drops a bit. */
vec2 hash_pcg(ivec2 whole)
{
  uvec2 x = uvec2(whole) * 1664525u + 1013904223u;
  x.x += x.y * 1664525u;
  x.y += x.x * 1664525u;
  x ^= uvec2(ivec2(x) >> 16);
  x.x += x.y * 1664525u;
  x.y += x.x * 1664525u;
  return vec2(x & 0x7fffffffu) * (1.0 / 2147483647.0);
}

vec3 hash_pcg(ivec3 whole)
{
  uvec3 x = uvec3(whole) * 1664525u + 1013904223u;
  x.x += x.y * x.z;
  x.y += x.z * x.x;
  x.z += x.x * x.y;
  x ^= uvec3(ivec3(x) >> 16);
  x.x += x.y * x.z;
  x.y += x.z * x.x;
  x.z += x.x * x.y;
  return vec3(x & 0x7fffffffu) * (1.0 / 2147483647.0);
}

vec4 hash_pcg(ivec4 whole)
{
  uvec4 x = uvec4(whole) * 1664525u + 1013904223u;
  x.x += x.y * x.w;
  x.y += x.z * x.x;
  x.z += x.x * x.y;
  x.w += x.y * x.z;
  x ^= uvec4(ivec4(x) >> 16);
  x.x += x.y * x.w;
  x.y += x.z * x.x;
  x.z += x.x * x.y;
  x.w += x.y * x.z;
  return vec4(x & 0x7fffffffu) * (1.0 / 2147483647.0);
}
