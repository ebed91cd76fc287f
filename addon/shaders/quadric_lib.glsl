/* What cylinders and cones share: roots of a t^2 + 2 b t + c, and angles around an axis. */

#define TWO_PI 6.283185307179586

#define QUADRIC_NO_ROOT 1e30

/* Roots of a t^2 + 2 b t + c: where the ray enters the body (the value falls) and where it leaves; for a > 0 in ascending,
 * for a < 0 in descending order. `discriminant` is b^2 - a c, not negative, given apart since b^2 - a c itself loses digits.
 * Neither root does: one is q / a, the other c / q (Numerical Recipes 5.6). */
vec2 quadric_roots(float a, float b, float c, float discriminant)
{
  float root = sqrt(discriminant);
  float q = b < 0.0 ? root - b : -root - b;
  float far = a != 0.0 ? q / a : QUADRIC_NO_ROOT;
  float near = q != 0.0 ? c / q : far;
  return b < 0.0 ? vec2(near, far) : vec2(far, near);
}

/* The paper's u = theta / 2 pi in [0, 1), equations (32), (39) and (45), of a direction with these two coordinates. */
float quadric_u(float x, float y)
{
  float u = (x == 0.0 && y == 0.0) ? 0.0 : atan(y, x) / TWO_PI;
  return u < 0.0 ? u + 1.0 : u;
}
