/* What the eye ray meets first, in four numbers: the film options that need geometry (depth cue, outlines) work with it.
 *
 * x: depth along the view. y: unit normal. z: number of what is drawn as one thing, negative for the triangles of a mesh; 0
 * where nothing is met. w: the group that it belongs to, where outlines go around groups. */
#define GUIDE_NORMAL_STEPS 4095.0

/* A unit vector as one whole number: on the octahedron, 12 bits for each of its two coordinates. (Cigolla and others 2014,
 * A Survey of Efficient Representations for Independent Unit Vectors.) */
float guide_packed_normal(vec3 n)
{
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 flipped = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  vec2 folded = n.z < 0.0 ? flipped : n.xy;
  vec2 whole = floor((0.5 * folded + 0.5) * GUIDE_NORMAL_STEPS + 0.5);
  return whole.x * (GUIDE_NORMAL_STEPS + 1.0) + whole.y;
}

vec3 guide_normal(vec4 guide)
{
  float high = floor(guide.y / (GUIDE_NORMAL_STEPS + 1.0));
  vec2 folded = vec2(high, guide.y - high * (GUIDE_NORMAL_STEPS + 1.0)) * (2.0 / GUIDE_NORMAL_STEPS) - 1.0;
  vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
  float below = max(-n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? below : -below, n.y < 0.0 ? below : -below);
  return normalize(n);
}

bool guide_is_hit(vec4 guide)
{
  return guide.z != 0.0;
}

/* How far a depth is gone in the depth cue, 0 to 1. */
float guide_depth_cue(float depth)
{
  float share = (depth - frame_depth_cue_start) / (frame_depth_cue_end - frame_depth_cue_start);
  return frame_depth_cue_strength * clamp(share, 0.0, 1.0);
}
