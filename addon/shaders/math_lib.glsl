/* What nodes of numbers and vectors compute, as Cycles computes it; their numpy twins are in
 * sync/shader_nodes/value_functions.py. What is not defined (a root of what is negative, a division by 0) is 0. */

/* a / b, 0 where b is. */
float math_divide(float a, float b)
{
  return b != 0.0 ? a / b : 0.0;
}

/* A negative number has powers of whole exponents only. 0 to a negative power is 0, as in Cycles on GPUs. */
float math_power(float a, float b)
{
  float size = a != 0.0 ? pow(abs(a), b) : 0.0;
  float sign_of_power = mod(b, 2.0) == 1.0 ? -1.0 : 1.0;
  float of_negative = b == floor(b) ? sign_of_power * size : 0.0;
  return b == 0.0 ? 1.0 : (a < 0.0 ? of_negative : size);
}

float math_logarithm(float a, float b)
{
  return a > 0.0 && b > 0.0 ? math_divide(log(a), log(b)) : 0.0;
}

float math_inverse_sqrt(float a)
{
  return a > 0.0 ? 1.0 / sqrt(a) : 0.0;
}

float math_sign(float a)
{
  return sign(a);
}

/* Whether a and b are the same within c. */
float math_compare(float a, float b, float c)
{
  return abs(a - b) <= max(c, 1.1920929e-7) ? 1.0 : 0.0;
}

/* The lower one of two, rounded where they differ by less than a width. */
float math_smooth_minimum(float a, float b, float width)
{
  float h = math_divide(max(width - abs(a - b), 0.0), width);
  return min(a, b) - h * h * h * width * (1.0 / 6.0);
}

float math_round(float a)
{
  return floor(a + 0.5);
}

float math_floor(float a)
{
  return floor(a);
}

float math_ceil(float a)
{
  return ceil(a);
}

float math_truncate(float a)
{
  return trunc(a);
}

float math_fraction(float a)
{
  return a - floor(a);
}

/* The remainder with the sign of a. */
float math_modulo(float a, float b)
{
  return b != 0.0 ? a - b * trunc(a / b) : 0.0;
}

/* The remainder with the sign of b. */
float math_floored_modulo(float a, float b)
{
  return b != 0.0 ? a - b * floor(a / b) : 0.0;
}

float math_wrap(float a, float high, float low)
{
  float width = high - low;
  return width != 0.0 ? a - width * floor((a - low) / width) : low;
}

float math_snap(float a, float b)
{
  return floor(math_divide(a, b)) * b;
}

/* a to and fro between 0 and b. */
float math_ping_pong(float a, float b)
{
  return b != 0.0 ? abs(math_fraction((a - b) / (2.0 * b)) * b * 2.0 - b) : 0.0;
}

float math_sine(float a)
{
  return sin(a);
}

float math_cosine(float a)
{
  return cos(a);
}

float math_tangent(float a)
{
  return tan(a);
}

/* By the other leg: drivers' own asin and acos have few digits. */
float math_arcsine(float a)
{
  float sine = clamp(a, -1.0, 1.0);
  return atan(sine, sqrt((1.0 - sine) * (1.0 + sine)));
}

float math_arccosine(float a)
{
  float cosine = clamp(a, -1.0, 1.0);
  return atan(sqrt((1.0 - cosine) * (1.0 + cosine)), cosine);
}

float math_arctangent(float a)
{
  return atan(a);
}

float math_arctan2(float a, float b)
{
  return a != 0.0 || b != 0.0 ? atan(a, b) : 0.0;
}

float math_sinh(float a)
{
  return sinh(a);
}

float math_cosh(float a)
{
  return cosh(a);
}

/* Some drivers divide two infinities where the argument is large; it is 1 long before. */
float math_tanh(float a)
{
  return tanh(clamp(a, -15.0, 15.0));
}

/* From here on vectors. */

float math_dot(vec3 a, vec3 b)
{
  return dot(a, b);
}

float math_length(vec3 a)
{
  return length(a);
}

vec3 math_normalize(vec3 a)
{
  float size = length(a);
  return size != 0.0 ? a / size : vec3(0.0);
}

vec3 math_cross(vec3 a, vec3 b)
{
  return cross(a, b);
}

vec3 math_project(vec3 a, vec3 b)
{
  return math_divide(dot(a, b), dot(b, b)) * b;
}

vec3 math_reflect(vec3 a, vec3 b)
{
  return reflect(a, math_normalize(b));
}

vec3 math_refract(vec3 a, vec3 b, float eta)
{
  return refract(a, math_normalize(b), eta);
}

vec3 math_faceforward(vec3 a, vec3 incident, vec3 reference)
{
  return dot(reference, incident) < 0.0 ? a : -a;
}

/* The images of the axes under a rotation by Euler angles, about x first: the columns of its matrix. */
vec3 math_turned_x(vec3 angles)
{
  vec3 c = cos(angles);
  vec3 s = sin(angles);
  return vec3(c.y * c.z, c.y * s.z, -s.y);
}

vec3 math_turned_y(vec3 angles)
{
  vec3 c = cos(angles);
  vec3 s = sin(angles);
  return vec3(s.x * s.y * c.z - c.x * s.z, s.x * s.y * s.z + c.x * c.z, s.x * c.y);
}

vec3 math_turned_z(vec3 angles)
{
  vec3 c = cos(angles);
  vec3 s = sin(angles);
  return vec3(c.x * s.y * c.z + s.x * s.z, c.x * s.y * s.z - s.x * c.z, c.x * c.y);
}

/* v turned about an axis by an angle, as Rodrigues has it; as it is where the axis is 0. */
vec3 math_rotate(vec3 v, vec3 axis, float angle)
{
  vec3 unit = math_normalize(axis);
  float c = cos(angle);
  vec3 turned = v * c + cross(unit, v) * sin(angle) + unit * (dot(unit, v) * (1.0 - c));
  return unit != vec3(0.0) ? turned : v;
}

/* Where x lies from `low` (0) to `high` (1), by the interpolation types of Map Range. */
float math_range_linear(float x, float low, float high)
{
  return math_divide(x - low, high - low);
}

float math_range_stepped(float x, float low, float high, float steps)
{
  return steps > 0.0 ? floor(math_range_linear(x, low, high) * (steps + 1.0)) / steps : 0.0;
}

float math_range_smooth(float x, float low, float high)
{
  float t = clamp(math_range_linear(x, low, high), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

float math_range_smoother(float x, float low, float high)
{
  float t = clamp(math_range_linear(x, low, high), 0.0, 1.0);
  return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}
