/* From vectors to the uv of an image: the projections of the nodes Image Texture and Environment Texture. */
#include "quadric_lib.glsl"

/* Angle of a vector in the plane, 0 at the origin, where atan means nothing. */
float projection_angle(float y, float x)
{
  return x == 0.0 && y == 0.0 ? 0.0 : atan(y, x);
}

/* A mirrored ball, seen from far along +Y. */
vec2 projection_mirror_ball(vec3 vector)
{
  float size = length(vector);
  vec3 half_way = (size > 0.0 ? vector / size : vec3(0.0)) - vec3(0.0, 1.0, 0.0);
  float scale = 2.0 * sqrt(max(-0.5 * half_way.y, 0.0));
  return 0.5 + 0.5 * (scale > 0.0 ? half_way.xz / scale : half_way.xz);
}

/* A globe in the unit cube. */
vec2 projection_sphere(vec3 point)
{
  vec3 vector = 2.0 * point - 1.0;
  float latitude = projection_angle(vector.z, length(vector.xy));
  bool nowhere = dot(vector, vector) == 0.0;
  float u = vector.x == 0.0 && vector.y == 0.0 ? 0.0 : 0.5 - projection_angle(vector.x, vector.y) / TWO_PI;
  return nowhere ? vec2(0.0) : vec2(u, 0.5 + latitude * (2.0 / TWO_PI));
}

/* A tube around Z in the unit cube. */
vec2 projection_tube(vec3 point)
{
  vec2 vector = 2.0 * point.xy - 1.0;
  bool nowhere = dot(vector, vector) == 0.0;
  return nowhere ? vec2(0.0) : vec2(0.5 - projection_angle(vector.x, vector.y) / TWO_PI, point.z);
}

/* The share of two sides of a box, the second the rest, where a normal leans to them by `a` and `b`. */
float projection_share(float a, float b, float blend)
{
  return clamp((a / (a + b) - 0.5 * (1.0 - blend)) / blend, 0.0, 1.0);
}

/* Shares of the three pairs of sides of a box, where its normal in object space is `normal`. Around the corners three
   images meet, along the edges two, within `blend`. */
vec3 projection_box(vec3 normal, float blend)
{
  vec3 n = abs(normal);
  n /= max(n.x + n.y + n.z, 1e-20);
  blend = max(blend, 1e-6);
  float limit = 0.5 * (1.0 + blend);
  vec3 others = n.yzx + n.zxy;
  vec3 alone = step(limit * (n + n.yzx), n) * step(limit * (n + n.zxy), n);
  if (alone.x + alone.y + alone.z > 0.0) {
    return alone.x > 0.0 ? vec3(1.0, 0.0, 0.0) : (alone.y > 0.0 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0));
  }
  if (n.z < (1.0 - limit) * others.z) {
    float share = projection_share(n.x, n.y, blend);
    return vec3(share, 1.0 - share, 0.0);
  }
  if (n.x < (1.0 - limit) * others.x) {
    float share = projection_share(n.y, n.z, blend);
    return vec3(0.0, share, 1.0 - share);
  }
  if (n.y < (1.0 - limit) * others.y) {
    float share = projection_share(n.x, n.z, blend);
    return vec3(share, 0.0, 1.0 - share);
  }
  return ((2.0 - limit) * n + (limit - 1.0)) / (2.0 * limit - 1.0);
}

/* The uv on the three pairs of sides: no image is mirrored. */
void projection_box_sides(vec3 point, vec3 normal, out vec2 x_side, out vec2 y_side, out vec2 z_side)
{
  x_side = vec2(normal.x < 0.0 ? 1.0 - point.y : point.y, point.z);
  y_side = vec2(normal.y > 0.0 ? 1.0 - point.x : point.x, point.z);
  z_side = vec2(normal.z > 0.0 ? 1.0 - point.y : point.y, point.x);
}
