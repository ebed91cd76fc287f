/* Cells around scattered points (Worley 1996, A Cellular Texture Basis Function) as Blender's Voronoi Texture has them:
 * the nearest point, the second one, all blended smoothly, how far the edge is, how large a ball around the point is.
 *
 * One function for each number of dimensions. Each looks at its cells in one loop within one of octaves: drivers
 * compile it once. Blender 5.0 changed the hash that scatters the points: VORONOI_LOOKUP3 is what was before. */
#include "hash_lib.glsl"

/* 0 is no texture at all. */
#define VORONOI_F1 1
#define VORONOI_F2 2
#define VORONOI_SMOOTH_F1 3
#define VORONOI_EDGE 4
#define VORONOI_RADIUS 5

#define VORONOI_EUCLIDEAN 0
#define VORONOI_MANHATTAN 1
#define VORONOI_CHEBYCHEV 2
#define VORONOI_MINKOWSKI 3

#define VORONOI_FAR 3.402823466e38

/* What is looked for, where the walk over the cells stands, and what it has found. Axes beyond the dimensions are 0. */
struct Voronoi {
  vec4 origin; /* of the texture */
  vec4 axes; /* 1 for each dimension */
  float detail, roughness, lacunarity, smoothness, exponent, randomness;
  int feature, metric;
  bool normalized;
  /* this octave */
  float scale, amplitude;
  vec4 cell, local;
  /* this cell */
  vec4 offset;
  float reach; /* cells either way */
  int round; /* 1 the second time around, when the nearest point is known */
  /* of the points, relative to the cell */
  float first, second;
  vec4 first_point, second_point, first_offset;
  vec3 first_color, second_color;
  /* of the octaves */
  float total, distance;
  vec3 color;
  vec4 position;
};

/* The point of a cell, in the unit square and so on, and the cell's color. */
vec4 voronoi_cell_1d(vec4 cell, out vec3 color)
{
  vec4 number = hash_numbers(cell.xxxx, vec4(0.0, 1.0, 2.0, 0.0));
  color = vec3(hash_numbers(cell).x, number.yz);
  return vec4(color.x, 0.0, 0.0, 0.0);
}

vec4 voronoi_cell_2d(vec4 cell, out vec3 color)
{
#ifdef VORONOI_LOOKUP3
  vec4 number = hash_numbers(cell.xxxx, cell.yyyy, vec4(1.0, 2.0, 0.0, 0.0));
  color = vec3(hash_numbers(cell.xxxx, cell.yyyy).x, number.xy);
  return vec4(color.xy, 0.0, 0.0);
#else
  color = hash_pcg(ivec3(cell.xy, 0));
  return vec4(hash_pcg(ivec2(cell.xy)), 0.0, 0.0);
#endif
}

vec4 voronoi_cell_3d(vec4 cell, out vec3 color)
{
#ifdef VORONOI_LOOKUP3
  vec4 number = hash_numbers(cell.xxxx, cell.yyyy, cell.zzzz, vec4(1.0, 2.0, 0.0, 0.0));
  color = vec3(hash_numbers(cell.xxxx, cell.yyyy, cell.zzzz).x, number.xy);
#else
  color = hash_pcg(ivec3(cell.xyz));
#endif
  return vec4(color, 0.0);
}

vec4 voronoi_cell_4d(vec4 cell, out vec3 color)
{
#ifdef VORONOI_LOOKUP3
  vec4 point = hash_numbers(cell.xwzy, cell.yxwz, cell.zyxw, cell.wzyx);
  color = vec3(point.x, hash_numbers(cell.zwzw, cell.xzxz, cell.wywy, cell.yxyx).xy);
#else
  vec4 point = hash_pcg(ivec4(cell));
  color = point.xyz;
#endif
  return point;
}

float voronoi_distance(vec4 way, int metric, float exponent)
{
  vec4 size = abs(way);
  if (metric == VORONOI_EUCLIDEAN) {
    return length(way);
  }
  if (metric == VORONOI_MANHATTAN) {
    return dot(size, vec4(1.0));
  }
  if (metric == VORONOI_CHEBYCHEV) {
    return max(max(size.x, size.y), max(size.z, size.w));
  }
  return pow(dot(pow(size, vec4(exponent)), vec4(1.0)), 1.0 / exponent);
}

Voronoi voronoi_begin(vec4 origin, int dimensions, float detail, float roughness, float lacunarity, float smoothness,
                      float exponent, float randomness, int feature, int metric, bool normalized)
{
  Voronoi v;
  v.origin = origin;
  v.axes = vec4(lessThan(ivec4(0, 1, 2, 3), ivec4(dimensions)));
  v.roughness = clamp(roughness, 0.0, 1.0);
  v.lacunarity = lacunarity;
  v.smoothness = clamp(0.5 * smoothness, 0.0, 0.5);
  v.exponent = exponent;
  v.randomness = clamp(randomness, 0.0, 1.0);
  v.feature = feature == VORONOI_SMOOTH_F1 && v.smoothness == 0.0 ? VORONOI_F1 : feature;
  v.metric = dimensions == 1 || feature >= VORONOI_EDGE ? VORONOI_EUCLIDEAN : metric;
  v.normalized = normalized && feature != VORONOI_RADIUS;
  v.detail = v.roughness == 0.0 || feature == VORONOI_RADIUS ? 0.0 : clamp(detail, 0.0, 15.0);
  v.detail = feature == 0 ? -1.0 : v.detail;
  v.reach = v.feature == VORONOI_SMOOTH_F1 ? 2.0 : 1.0;
  v.scale = 1.0;
  v.amplitude = 1.0;
  v.total = feature == VORONOI_EDGE ? 1.0 : 0.0;
  v.distance = feature == VORONOI_EDGE ? 8.0 : 0.0;
  v.color = vec3(0.0);
  v.position = vec4(0.0);
  return v;
}

void voronoi_enter(inout Voronoi v)
{
  vec4 place = v.origin * v.scale;
  v.cell = floor(place);
  v.local = place - v.cell;
  v.offset = -v.reach * v.axes;
  v.round = 0;
  v.first = VORONOI_FAR;
  v.second = VORONOI_FAR;
  v.first_point = vec4(0.0);
  v.second_point = vec4(0.0);
  v.first_offset = vec4(0.0);
  v.first_color = vec3(0.0);
  v.second_color = vec3(0.0);
}

/* The cell that the walk has come to: around that of the nearest point where a ball about it is looked for. */
vec4 voronoi_offset(Voronoi v)
{
  return v.offset + (v.round > 0 && v.feature == VORONOI_RADIUS ? v.first_offset : vec4(0.0));
}

bool voronoi_walks(Voronoi v)
{
  return v.round < (v.feature >= VORONOI_EDGE ? 2 : 1);
}

/* On to the next cell, the first axis fastest; behind the last one all begins again. */
void voronoi_next(inout Voronoi v, int dimensions)
{
  float above = v.reach + 0.5;
  float back = 2.0 * v.reach + 1.0;
  v.offset.x += 1.0;
  float carry = step(above, v.offset.x);
  v.offset.x -= back * carry;
  if (dimensions > 1) {
    v.offset.y += carry;
    carry = step(above, v.offset.y);
    v.offset.y -= back * carry;
  }
  if (dimensions > 2) {
    v.offset.z += carry;
    carry = step(above, v.offset.z);
    v.offset.z -= back * carry;
  }
  if (dimensions > 3) {
    v.offset.w += carry;
    carry = step(above, v.offset.w);
    v.offset.w -= back * carry;
  }
  v.round += carry > 0.0 ? 1 : 0;
}

/* Blends a point into those before, by how much nearer it is. */
void voronoi_blend(inout Voronoi v, vec4 point, vec3 color, float away)
{
  bool alone = v.first == VORONOI_FAR;
  float t = alone ? 1.0 : smoothstep(0.0, 1.0, 0.5 + 0.5 * (v.first - away) / v.smoothness);
  float less = v.smoothness * t * (1.0 - t);
  v.first = mix(alone ? 0.0 : v.first, away, t) - less;
  less /= 1.0 + 3.0 * v.smoothness;
  v.first_color = mix(v.first_color, color, t) - less;
  v.first_point = mix(v.first_point, point, t) - less * v.axes;
}

/* The second time around: the nearest edge, or half the way from the nearest point to its next. */
void voronoi_meet_again(inout Voronoi v, vec4 point)
{
  vec4 across = point - v.first_point;
  float square = dot(across, across);
  if (v.feature == VORONOI_EDGE && square > 0.0001) {
    v.second = min(v.second, dot(0.5 * (v.first_point + point) - v.local, across) * inversesqrt(square));
  }
  if (v.feature == VORONOI_RADIUS && dot(abs(v.offset), vec4(1.0)) > 0.5) {
    v.second = min(v.second, 0.5 * sqrt(square));
  }
}

/* Takes the point of a cell into account, given in the unit square and so on. */
void voronoi_meet(inout Voronoi v, vec4 within, vec3 color)
{
  vec4 point = voronoi_offset(v) + v.randomness * within;
  float away = voronoi_distance(point - v.local, v.metric, v.exponent);
  if (v.round > 0) {
    voronoi_meet_again(v, point);
  }
  else if (v.feature == VORONOI_SMOOTH_F1) {
    voronoi_blend(v, point, color, away);
  }
  else if (away < v.first) {
    if (v.feature == VORONOI_F2) {
      v.second = v.first;
      v.second_point = v.first_point;
      v.second_color = v.first_color;
    }
    v.first = away;
    v.first_point = point;
    v.first_color = color;
    v.first_offset = v.offset;
  }
  else if (v.feature == VORONOI_F2 && away < v.second) {
    v.second = away;
    v.second_point = point;
    v.second_color = color;
  }
}

/* Adds what an octave found; the last one counts by the digits of the detail behind the point. */
void voronoi_leave(inout Voronoi v, float octave)
{
  float share = v.amplitude * min(v.detail - octave + 1.0, 1.0);
  if (v.feature == VORONOI_EDGE) {
    v.total = mix(v.total, 1.0 / v.scale, share);
    v.distance = mix(v.distance, min(v.distance, v.second / v.scale), share);
  }
  else {
    bool is_second = v.feature == VORONOI_F2;
    v.total += share;
    v.distance += share * (is_second || v.feature == VORONOI_RADIUS ? v.second : v.first);
    v.color += share * (is_second ? v.second_color : v.first_color);
    v.position = mix(v.position, (v.cell + (is_second ? v.second_point : v.first_point)) / v.scale, share);
  }
  v.scale *= v.lacunarity;
  v.amplitude *= v.roughness;
}

/* The distance or radius; the distance and the color are at most 1 or so when normalized. `scale`: of the texture. */
float voronoi_end(Voronoi v, float scale, out vec3 color, out vec4 position)
{
  bool colored = v.feature < VORONOI_EDGE;
  float half_side = 0.5 + 0.5 * v.randomness;
  float corner = voronoi_distance(half_side * v.axes, v.metric, v.exponent) * (v.feature == VORONOI_F2 ? 2.0 : 1.0);
  color = colored ? v.color / (v.normalized ? v.total : 1.0) : vec3(0.0);
  position = colored && scale != 0.0 ? v.position / scale : vec4(0.0);
  return v.distance / (v.normalized ? v.total * (colored ? corner : half_side) : 1.0);
}

float voronoi_texture_1d(float w, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  vec4 origin = vec4(scale * w, 0.0, 0.0, 0.0);
  Voronoi v = voronoi_begin(origin, 1, detail, roughness, lacunarity, smoothness, exponent, randomness, feature, metric,
                            normalized);
  for (float octave = 0.0; octave < v.detail + 1.0; octave++) {
    voronoi_enter(v);
    while (voronoi_walks(v)) {
      vec3 tint;
      vec4 within = voronoi_cell_1d(v.cell + voronoi_offset(v), tint);
      voronoi_meet(v, within, tint);
      voronoi_next(v, 1);
    }
    voronoi_leave(v, octave);
  }
  float distance = voronoi_end(v, scale, color, position);
  position = position.yzwx;
  return distance;
}

float voronoi_texture_2d(vec2 place, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  vec4 origin = vec4(scale * place, 0.0, 0.0);
  Voronoi v = voronoi_begin(origin, 2, detail, roughness, lacunarity, smoothness, exponent, randomness, feature, metric,
                            normalized);
  for (float octave = 0.0; octave < v.detail + 1.0; octave++) {
    voronoi_enter(v);
    while (voronoi_walks(v)) {
      vec3 tint;
      vec4 within = voronoi_cell_2d(v.cell + voronoi_offset(v), tint);
      voronoi_meet(v, within, tint);
      voronoi_next(v, 2);
    }
    voronoi_leave(v, octave);
  }
  return voronoi_end(v, scale, color, position);
}

float voronoi_texture_3d(vec3 place, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  vec4 origin = vec4(scale * place, 0.0);
  Voronoi v = voronoi_begin(origin, 3, detail, roughness, lacunarity, smoothness, exponent, randomness, feature, metric,
                            normalized);
  for (float octave = 0.0; octave < v.detail + 1.0; octave++) {
    voronoi_enter(v);
    while (voronoi_walks(v)) {
      vec3 tint;
      vec4 within = voronoi_cell_3d(v.cell + voronoi_offset(v), tint);
      voronoi_meet(v, within, tint);
      voronoi_next(v, 3);
    }
    voronoi_leave(v, octave);
  }
  return voronoi_end(v, scale, color, position);
}

float voronoi_texture_4d(vec3 place, float w, float scale, float detail, float roughness, float lacunarity,
                         float smoothness, float exponent, float randomness, int feature, int metric, bool normalized,
                         out vec3 color, out vec4 position)
{
  vec4 origin = scale * vec4(place, w);
  Voronoi v = voronoi_begin(origin, 4, detail, roughness, lacunarity, smoothness, exponent, randomness, feature, metric,
                            normalized);
  for (float octave = 0.0; octave < v.detail + 1.0; octave++) {
    voronoi_enter(v);
    while (voronoi_walks(v)) {
      vec3 tint;
      vec4 within = voronoi_cell_4d(v.cell + voronoi_offset(v), tint);
      voronoi_meet(v, within, tint);
      voronoi_next(v, 4);
    }
    voronoi_leave(v, octave);
  }
  return voronoi_end(v, scale, color, position);
}

/* The same as Blender before 5.0 has it: to call these is to choose its hash. */
#ifdef VORONOI_LOOKUP3
float voronoi_lookup3_1d(float w, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  return voronoi_texture_1d(w, scale, detail, roughness, lacunarity, smoothness, exponent, randomness, feature,
                            metric, normalized, color, position);
}

float voronoi_lookup3_2d(vec2 place, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  return voronoi_texture_2d(place, scale, detail, roughness, lacunarity, smoothness, exponent, randomness, feature,
                            metric, normalized, color, position);
}

float voronoi_lookup3_3d(vec3 place, float scale, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness, int feature, int metric, bool normalized, out vec3 color,
                         out vec4 position)
{
  return voronoi_texture_3d(place, scale, detail, roughness, lacunarity, smoothness, exponent, randomness, feature,
                            metric, normalized, color, position);
}

float voronoi_lookup3_4d(vec3 place, float w, float scale, float detail, float roughness, float lacunarity,
                         float smoothness, float exponent, float randomness, int feature, int metric, bool normalized,
                         out vec3 color, out vec4 position)
{
  return voronoi_texture_4d(place, w, scale, detail, roughness, lacunarity, smoothness, exponent, randomness, feature,
                            metric, normalized, color, position);
}
#endif
