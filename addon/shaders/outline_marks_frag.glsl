/* Where the lines of one sample of the picture run: marks pixels whose neighbour is another thing.
 *
 * Of two pixels one is marked: the farther, which leaves what is small in front its size. Of the eight neighbours the diagonal
 * ones count less, so that a line is as dark at every angle. out_mark: share of an outline, share of an inner line. */
#include "guide_lib.glsl"

#define OUTLINE_DIAGONAL 0.4142
/* Two primitives with a smaller angle between them than about 10 degrees are one surface: pieces of a curve. */
#define OUTLINE_JOINT_COSINE 0.985
/* Cosines that differ by less are the same. */
#define OUTLINE_ALIKE 1e-3

/* The point of a guide relative to the eye, or to the window of an orthographic camera. */
vec3 outline_point(vec2 pixel, float depth)
{
  vec2 window = pixel * frame_raster.xy + frame_raster.zw;
  vec3 across = window.x * frame_camera_right + window.y * frame_camera_up;
  return depth * frame_camera_forward + (frame_orthographic > 0.5 ? across : depth * across);
}

/* What the middle of a pixel sees: its guide, where that is relative to the eye, and how much it faces the eye. */
struct Seen {
  vec4 guide;
  vec3 point;
  vec3 normal;
  float facing;
};

Seen outline_seen(vec2 pixel, vec4 guide)
{
  Seen seen;
  seen.guide = guide;
  seen.point = outline_point(pixel, guide.x);
  seen.normal = guide_normal(guide);
  vec3 view = frame_orthographic > 0.5 ? frame_camera_forward : normalize(seen.point);
  seen.facing = -dot(seen.normal, view);
  return seen;
}

/* Whether there is a step between two places: each is judged by the plane of the other, as surfaces seen at a grazing angle
 * run far from one pixel to the next. */
bool outline_steps(Seen a, Seen b)
{
  vec3 between = b.point - a.point;
  float apart = max(abs(dot(between, a.normal)), abs(dot(between, b.normal)));
  return apart > frame_outline_step * (frame_orthographic > 0.5 ? 1.0 : min(a.guide.x, b.guide.x));
}

/* Whether the line between two places is drawn `here`: behind a step, else on the side that is turned away more, which is the
 * same all along an edge. Where both are alike one is chosen, by number or by where the other one is. */
bool outline_is_here(Seen here, Seen there, bool steps, ivec2 offset)
{
  if (steps) {
    return here.guide.x > there.guide.x;
  }
  float turned = there.facing - here.facing;
  if (abs(turned) > OUTLINE_ALIKE) {
    return turned > 0.0;
  }
  float order = here.guide.z - there.guide.z;
  return order == 0.0 ? offset.x + 3 * offset.y > 0 : order > 0.0;
}

/* The line between two places as it is drawn `here`: x for an outline, y for an inner line. */
vec2 outline_between(Seen here, Seen there, ivec2 offset)
{
  if (!guide_is_hit(there.guide) || !guide_is_hit(here.guide)) {
    return vec2(guide_is_hit(there.guide) ? 1.0 : 0.0, 0.0);
  }
  bool steps = outline_steps(here, there);
  if (!outline_is_here(here, there, steps, offset)) {
    return vec2(0.0);
  }
  bool same = here.guide.z == there.guide.z;
  float cosine = dot(here.normal, there.normal);
  bool outlined = here.guide.w != there.guide.w;
#ifdef OUTLINE_SHAPES
  outlined = !same && (steps || cosine < OUTLINE_JOINT_COSINE);
#endif
  bool may_crease = !same || here.guide.z < 0.0; /* a single exact shape is smooth however fast its normal turns */
  bool inner = !outlined && (steps || (may_crease && cosine < frame_outline_crease));
  return vec2(outlined ? 1.0 : 0.0, inner ? 1.0 : 0.0);
}

void main()
{
  ivec2 size = textureSize(guide_data, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  Seen here = outline_seen(gl_FragCoord.xy, texelFetch(guide_data, pixel, 0));
  vec2 mark = vec2(0.0);
  for (int i = 0; i < 9; i++) {
    ivec2 offset = ivec2(i % 3, i / 3) - 1;
    ivec2 other = clamp(pixel + offset, ivec2(0), size - 1);
    if (other != pixel) {
      Seen there = outline_seen(vec2(other) + 0.5, texelFetch(guide_data, other, 0));
      vec2 lines = outline_between(here, there, offset);
#ifdef HAS_DEPTH_CUE
      lines *= 1.0 - guide_depth_cue(there.guide.x);
#endif
      mark = max(mark, (offset.x == 0 || offset.y == 0 ? 1.0 : OUTLINE_DIAGONAL) * lines);
    }
  }
  out_mark = vec4(mark, 0.0, 0.0);
}
