/* What nodes of colors compute, as Cycles computes it; their numpy twins are in sync/shader_nodes/value_functions.py. */
#include <constant>

float color_hue(vec3 color, float high, float spread)
{
  vec3 c = (vec3(high) - color) / (spread > 0.0 ? spread : 1.0);
  float of_others = color.g == high ? 2.0 + c.r - c.b : 4.0 + c.g - c.r;
  float hue = (color.r == high ? c.b - c.g : of_others) / 6.0;
  return spread > 0.0 ? hue - floor(hue) : 0.0;
}

vec3 color_to_hsv(vec3 color)
{
  float high = max(color.r, max(color.g, color.b));
  float spread = high - min(color.r, min(color.g, color.b));
  float saturation = high != 0.0 ? spread / high : 0.0;
  return vec3(saturation != 0.0 ? color_hue(color, high, spread) : 0.0, saturation, high);
}

/* Hues beyond 0 to 1 are of the last sixth, as in Cycles. */
vec3 color_from_hsv(vec3 hsv)
{
  float hue = (hsv.x == 1.0 ? 0.0 : hsv.x) * 6.0;
  float sector = floor(hue);
  float v = hsv.z;
  float p = v * (1.0 - hsv.y);
  float q = v * (1.0 - hsv.y * (hue - sector));
  float t = v * (1.0 - hsv.y * (1.0 - hue + sector));
  vec3 first = sector == 0.0 ? vec3(v, t, p) : (sector == 1.0 ? vec3(q, v, p) : vec3(p, v, t));
  vec3 last = sector == 3.0 ? vec3(p, q, v) : (sector == 4.0 ? vec3(t, p, v) : vec3(v, p, q));
  return sector >= 0.0 && sector <= 2.0 ? first : last;
}

vec3 color_to_hsl(vec3 color)
{
  float high = max(color.r, max(color.g, color.b));
  float low = min(color.r, min(color.g, color.b));
  float lightness = min(1.0, (high + low) * 0.5);
  float most = lightness > 0.5 ? 2.0 - high - low : high + low;
  float saturation = most != 0.0 ? (high - low) / most : 0.0;
  return vec3(color_hue(color, high, high - low), saturation, lightness);
}

vec3 color_from_hsl(vec3 hsl)
{
  float hue = hsl.x * 6.0;
  vec3 pure = clamp(vec3(abs(hue - 3.0) - 1.0, 2.0 - abs(hue - 2.0), 2.0 - abs(hue - 4.0)), 0.0, 1.0);
  return (pure - 0.5) * ((1.0 - abs(2.0 * hsl.z - 1.0)) * hsl.y) + hsl.z;
}

/* The blend types of the Mix node: a, which b changes, by the factor t. */

vec3 color_blend_divide(float t, vec3 a, vec3 b)
{
  return vec3(b.r != 0.0 ? mix(a.r, a.r / b.r, t) : a.r,
              b.g != 0.0 ? mix(a.g, a.g / b.g, t) : a.g,
              b.b != 0.0 ? mix(a.b, a.b / b.b, t) : a.b);
}

vec3 color_blend_screen(float t, vec3 a, vec3 b)
{
  return 1.0 - (1.0 - t + t * (1.0 - b)) * (1.0 - a);
}

vec3 color_blend_overlay(float t, vec3 a, vec3 b)
{
  vec3 dark = a * (1.0 - t + 2.0 * t * b);
  vec3 bright = 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a);
  return vec3(a.r < 0.5 ? dark.r : bright.r, a.g < 0.5 ? dark.g : bright.g, a.b < 0.5 ? dark.b : bright.b);
}

vec3 color_blend_soft_light(float t, vec3 a, vec3 b)
{
  vec3 screen = 1.0 - (1.0 - b) * (1.0 - a);
  return mix(a, (1.0 - a) * b * a + a * screen, t);
}

vec3 color_blend_exclusion(float t, vec3 a, vec3 b)
{
  return max(mix(a, a + b - 2.0 * a * b, t), 0.0);
}

float color_dodged(float t, float a, float b)
{
  float left = 1.0 - t * b;
  return a != 0.0 ? (left > 0.0 ? min(a / left, 1.0) : 1.0) : a;
}

vec3 color_blend_dodge(float t, vec3 a, vec3 b)
{
  return vec3(color_dodged(t, a.r, b.r), color_dodged(t, a.g, b.g), color_dodged(t, a.b, b.b));
}

float color_burnt(float t, float a, float b)
{
  float left = 1.0 - t + t * b;
  return left > 0.0 ? clamp(1.0 - (1.0 - a) / left, 0.0, 1.0) : 0.0;
}

vec3 color_blend_burn(float t, vec3 a, vec3 b)
{
  return vec3(color_burnt(t, a.r, b.r), color_burnt(t, a.g, b.g), color_burnt(t, a.b, b.b));
}

vec3 color_blend_hue(float t, vec3 a, vec3 b)
{
  vec3 other = color_to_hsv(b);
  vec3 own = color_to_hsv(a);
  return other.y != 0.0 ? mix(a, color_from_hsv(vec3(other.x, own.y, own.z)), t) : a;
}

vec3 color_blend_saturation(float t, vec3 a, vec3 b)
{
  vec3 own = color_to_hsv(a);
  float saturation = mix(own.y, color_to_hsv(b).y, t);
  return own.y != 0.0 ? color_from_hsv(vec3(own.x, saturation, own.z)) : a;
}

vec3 color_blend_value(float t, vec3 a, vec3 b)
{
  vec3 own = color_to_hsv(a);
  return color_from_hsv(vec3(own.x, own.y, mix(own.z, color_to_hsv(b).z, t)));
}

vec3 color_blend_color(float t, vec3 a, vec3 b)
{
  vec3 other = color_to_hsv(b);
  return other.y != 0.0 ? mix(a, color_from_hsv(vec3(other.x, other.y, color_to_hsv(a).z)), t) : a;
}

/* Other nodes. */

vec3 color_gamma(vec3 color, float exponent)
{
  vec3 bent = pow(max(color, 1e-30), vec3(exponent));
  bent = vec3(color.r > 0.0 ? bent.r : color.r, color.g > 0.0 ? bent.g : color.g, color.b > 0.0 ? bent.b : color.b);
  return exponent == 0.0 ? vec3(1.0) : bent;
}

vec3 color_bright_contrast(vec3 color, float bright, float contrast)
{
  return max((1.0 + contrast) * color + (bright - 0.5 * contrast), 0.0);
}

vec3 color_hue_saturation(vec3 color, float hue, float saturation, float value, float factor)
{
  vec3 hsv = color_to_hsv(color);
  float turned = hsv.x + hue + 0.5;
  vec3 changed = color_from_hsv(vec3(turned - floor(turned), clamp(hsv.y * saturation, 0.0, 1.0), hsv.z * value));
  return max(mix(color, changed, factor), 0.0);
}

/* Tables: rows of colors from texel `first` on, of even places from 0 to 1. */

/* The color at x between `count` rows; beyond them as at the ends, or with `extends` 1 as straight as it is there. */
vec4 color_of_table(int first, int count, int extends, float x)
{
  float place = (extends == 1 ? x : clamp(x, 0.0, 1.0)) * float(count - 1);
  int row = int(clamp(place, 0.0, float(count - 2)));
  return mix(fetch_tables(first + row), fetch_tables(first + row + 1), place - float(row));
}

/* The color at x of a ramp of steps: 256 rows of its colors, then for each row where, from its place (0) to the next one's
 * (1), the step between the two lies. */
vec4 color_of_steps(int first, float x)
{
  float place = clamp(x, 0.0, 1.0) * 255.0;
  int row = min(int(place), 254);
  float step_at = fetch_tables(first + 256 + row).r;
  return fetch_tables(first + row + (place - float(row) < step_at ? 0 : 1));
}

/* Three curves, each at its own number. */
vec3 color_of_curves(int first, int extends, vec3 x)
{
  return vec3(color_of_table(first, 256, extends, x.r).r,
              color_of_table(first, 256, extends, x.g).g,
              color_of_table(first, 256, extends, x.b).b);
}
