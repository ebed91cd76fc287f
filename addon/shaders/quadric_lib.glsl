/* What cylinders and cones share: roots of a t^2 + 2 b t + c, and angles around an axis. */

#define TWO_PI 6.283185307179586

/* Both roots in ascending order. `discriminant` is b^2 - a c, not negative, given apart since it is best computed from the
 * point of the ray closest to the body. Neither root loses digits: one is q / a, the other c / q (Numerical Recipes 5.6).
 * A root that does not exist is negative. */
vec2 quadric_roots(float a, float b, float c, float discriminant)
{
  float root = sqrt(discriminant);
  float q = b < 0.0 ? root - b : -root - b;
  float t0 = abs(a) > 1e-12 ? q / a : -1.0;
  float t1 = q != 0.0 ? c / q : t0;
  return vec2(min(t0, t1), max(t0, t1));
}

/* The paper's u = theta / 2 pi in [0, 1), equations (32), (39) and (45), of a direction with these two coordinates. */
float quadric_u(float x, float y)
{
  float u = (x == 0.0 && y == 0.0) ? 0.0 : atan(y, x) / TWO_PI;
  return u < 0.0 ? u + 1.0 : u;
}
