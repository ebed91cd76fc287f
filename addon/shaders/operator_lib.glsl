/* Arithmetic that GLSL has no operators for, for numbers and vectors alike. */
#include "optics_lib.glsl"

float operator_divided(float a, float b)
{
  return b != 0.0 ? a / b : 0.0;
}

vec2 operator_divided(vec2 a, vec2 b)
{
  return vec2(operator_divided(a.x, b.x), operator_divided(a.y, b.y));
}

vec3 operator_divided(vec3 a, vec3 b)
{
  return vec3(operator_divided(a.xy, b.xy), operator_divided(a.z, b.z));
}

/* What a node may make, NaN and infinity among it, as a number within limits. */
float operator_within(float a, float low, float high)
{
  return a > low ? min(a, high) : low;
}

vec3 operator_within(vec3 a, float low, float high)
{
  return vec3(operator_within(a.x, low, high), operator_within(a.y, low, high), operator_within(a.z, low, high));
}
