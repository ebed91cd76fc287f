/* Patterns that cost little: Blender's Gradient, Checker, Brick, Magic and Wave Textures. */
#include "quadric_lib.glsl"

#define PATTERN_LINEAR 0
#define PATTERN_QUADRATIC 1
#define PATTERN_EASING 2
#define PATTERN_DIAGONAL 3
#define PATTERN_RADIAL 4
#define PATTERN_BALL 5
#define PATTERN_QUADRATIC_BALL 6

#define PATTERN_SINE 0
#define PATTERN_SAW 1

/* A little off whole numbers, where faces of a unit cube lie. */
vec3 pattern_off_unit(vec3 place)
{
  return (place + 0.000001) * 0.999999;
}

float pattern_gradient(vec3 place, int kind)
{
  float x = clamp(place.x, 0.0, 1.0);
  float ball = clamp(0.999999 - length(place), 0.0, 1.0);
  if (kind == PATTERN_QUADRATIC) {
    return x * x;
  }
  if (kind == PATTERN_EASING) {
    return x * x * (3.0 - 2.0 * x);
  }
  if (kind == PATTERN_DIAGONAL) {
    return clamp(0.5 * (place.x + place.y), 0.0, 1.0);
  }
  if (kind == PATTERN_RADIAL) {
    return place.x == 0.0 && place.y == 0.0 ? 0.5 : atan(place.y, place.x) / TWO_PI + 0.5;
  }
  if (kind == PATTERN_BALL) {
    return ball;
  }
  return kind == PATTERN_QUADRATIC_BALL ? ball * ball : x;
}

/* 1 in the cubes of the first color, 0 in those of the second. */
float pattern_checker(vec3 place)
{
  ivec3 cube = ivec3(floor(pattern_off_unit(place)));
  return float((cube.x + cube.y + cube.z) & 1);
}

/* Whole numbers from 0 to 1 (of Hugo Elias' noise). */
float pattern_integer_noise(uint n)
{
  n = (n + 1013u) & 0x7fffffffu;
  n = (n >> 13u) ^ n;
  n = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
  return float(n) * (1.0 / 2147483648.0);
}

/* The share of mortar; `tint`: where a brick is between the two colors. Every so many rows are moved by `offset`
 * bricks, and every so many have bricks `squash` times as wide. */
float pattern_brick(vec3 place, float mortar, float smoothness, float bias, float width, float height, float offset,
                    int offset_rows, float squash, int squash_rows, out float tint)
{
  int row = int(floor(place.y / height));
  width *= abs(row) % max(squash_rows, 1) == 0 ? squash : 1.0;
  float along = place.x + (abs(row) % max(offset_rows, 1) == 0 ? width * offset : 0.0);
  int brick = int(floor(along / width));
  uint number = (uint(row) << 16u) + (uint(brick) & 0xffffu);
  tint = clamp(pattern_integer_noise(number) + bias, 0.0, 1.0);
  vec2 low = vec2(along - width * float(brick), place.y - height * float(row));
  vec2 edge = min(low, vec2(width, height) - low);
  float away = min(edge.x, edge.y);
  float within = away < mortar ? 1.0 : 0.0;
  return smoothness == 0.0 ? within : within * smoothstep(0.0, 1.0, (1.0 - away / mortar) / smoothness);
}

/* Waves that bend each other, `depth` times. */
vec3 pattern_magic(vec3 place, int depth, float distortion)
{
  vec3 p = place - TWO_PI * trunc(place / TWO_PI); /* few digits are left in sines of large numbers */
  float x = sin((p.x + p.y + p.z) * 5.0);
  float y = cos((-p.x + p.y - p.z) * 5.0);
  float z = -cos((-p.x - p.y + p.z) * 5.0);
  float d = distortion;
  x = depth > 0 ? d * x : x;
  z = depth > 0 ? d * z : z;
  y = depth > 0 ? -d * cos(x - d * y + z) : y;
  x = depth > 1 ? d * cos(x - y - z) : x;
  z = depth > 2 ? d * sin(-x - y - z) : z;
  x = depth > 3 ? -d * cos(-x + y - z) : x;
  y = depth > 4 ? -d * sin(-x + y + z) : y;
  y = depth > 5 ? -d * cos(-x + y + z) : y;
  x = depth > 6 ? d * cos(x + y + z) : x;
  z = depth > 7 ? d * sin(x + y - z) : z;
  x = depth > 8 ? -d * cos(-x - y + z) : x;
  y = depth > 9 ? -d * sin(x - y + z) : y;
  return 0.5 - vec3(x, y, z) / (d != 0.0 ? 2.0 * d : 1.0);
}

/* The phase of waves along an axis, and around one: `size` is 0 along those axes that do not count. */
float pattern_bands(vec3 place, vec3 axis)
{
  return dot(place, axis);
}

float pattern_rings(vec3 place, vec3 size)
{
  return length(place * size);
}

/* A wave, 0 to 1, at a phase. */
float pattern_wave(float phase, int profile)
{
  float turns = phase / TWO_PI;
  if (profile == PATTERN_SINE) {
    return 0.5 - 0.5 * cos(phase);
  }
  return profile == PATTERN_SAW ? fract(turns) : 2.0 * abs(turns - floor(turns + 0.5));
}
