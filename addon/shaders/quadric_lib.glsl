/* What cylinders and cones share: the intersection with their side, and angles around an axis. */
#include "ray_lib.glsl"

#define TWO_PI 6.283185307179586
#define QUADRIC_NO_ROOT 1e30
#define QUADRIC_NO_HEIGHT 1e-30

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

/* Nearest t in (0, t_max), else t_max, on a side whose radius R(z) = r0 + k z, k the slope, grows linearly along the unit axis
 * from the base's centre to the apex's, up to the height. |p x axis|^2 = R^2 holds the paper's cylinder (8) and cone (11) without a tip that would
 * lie far away for a nearly cylindrical one; between the ends R keeps its sign, so the mirrored nappe is never met.
 *
 * Along the ray this is a t^2 + 2 b t + c = 0, measured from the ray's point closest to the middle of the body, so that the
 * digits left are those of the body's size. The discriminant b^2 - a c would lose them again; it equals
 * |R d - k dz p|^2 - |p x d|^2, p and d across the axis, where both squares keep theirs: (l - m)(l + m) of the lengths
 * would be no better, since they are rounded too, and takes two more roots. A ray steeper than the side
 * (a < 0) always meets the double cone, whatever rounding says near the tip. */
float quadric_side_hit(vec3 base, vec3 axis, float height, float base_radius, float slope, bool outside_seen, Ray ray,
                       float t_max)
{
  vec3 to_middle = (0.5 * height) * axis;
  vec3 from_middle = (ray.origin - base) - to_middle;
  float closest = -dot(from_middle, ray.direction);
  vec3 offset = from_middle + closest * ray.direction + to_middle;
  float z = dot(offset, axis);
  float dz = dot(ray.direction, axis);
  vec3 position = offset - z * axis;
  vec3 direction = ray.direction - dz * axis;
  float radius = base_radius + slope * z;
  float growth = slope * dz;
  float a = dot(direction, direction) - growth * growth;
  vec3 to_edge = radius * direction - growth * position;
  vec3 to_ray = cross(position, direction);
  float discriminant = dot(to_edge, to_edge) - dot(to_ray, to_ray);
  if (discriminant < 0.0 && a >= 0.0) {
    return t_max;
  }
  float b = dot(position, direction) - growth * radius;
  float c = dot(position, position) - radius * radius;
  vec2 roots = quadric_roots(a, b, c, max(discriminant, 0.0));
  vec2 heights = vec2(z) + roots * dz;
  roots += closest;
  bool enters = outside_seen && roots.x > 0.0 && heights.x >= 0.0 && heights.x <= height;
  bool leaves = roots.y > 0.0 && heights.y >= 0.0 && heights.y <= height;
  return min(t_max, min(enters ? roots.x : t_max, leaves ? roots.y : t_max));
}

/* The same with the way from the base's centre to the apex's; where it is 0 the body is a sphere. */
float quadric_hit(vec3 base, vec3 along, float base_radius, float apex_radius, bool outside_seen, Ray ray, float t_max)
{
  float height = length(along);
  float per_height = 1.0 / max(height, QUADRIC_NO_HEIGHT);
  return quadric_side_hit(base, per_height * along, height, base_radius, per_height * (apex_radius - base_radius),
                          outside_seen, ray, t_max);
}

/* The paper's u = theta / 2 pi in [0, 1), equations (32), (39) and (45), of a direction with these two coordinates. */
float quadric_u(float x, float y)
{
  float u = (x == 0.0 && y == 0.0) ? 0.0 : atan(y, x) / TWO_PI;
  return u < 0.0 ? min(u + 1.0, 0.99999994) : u;
}
