/* Which of many lights a point asks: one by chance, the likelier the more it may give, or, without chance, those at hand one by
 * one and those far off by clusters. See `light_tree`. */
#include "optics_lib.glsl"
#include "sampling_lib.glsl"
#include <light_node>

#define LIGHT_PICKS 4 /* lights that are chosen for a point */

/* The cosine of a - b, 1 where that is negative, of angles between 0 and pi. */
float light_tree_between(float cos_a, float cos_b)
{
  float sines = sqrt(max((1.0 - cos_a * cos_a) * (1.0 - cos_b * cos_b), 0.0));
  return cos_a >= cos_b ? 1.0 : cos_a * cos_b + sines;
}

/* About what the lights of a node give a point if nothing is in the way, 0 only where they give nothing (Conty Estevez and
 * Kulla 2018). `around`: light from behind the surface counts as well. */
float light_tree_importance(LightNode node, vec3 point, vec3 normal, bool around)
{
  vec3 to_light = node.center - point;
  float square = dot(to_light, to_light);
  vec3 direction = to_light / max(sqrt(square), 1e-30);
  float radius_square = node.radius * node.radius;
  /* half the angle under which the node is seen */
  float cos_seen = radius_square < square ? sqrt(1.0 - radius_square / square) : -1.0;
  float facing = around ? 1.0 : max(light_tree_between(dot(normal, direction), cos_seen), 0.0);
  float shining = 1.0;
  if (node.cos_axis >= -1.0) {
    float off = light_tree_between(light_tree_between(-dot(node.axis, direction), node.cos_axis), cos_seen);
    shining = off > node.cos_reach ? max(off, 0.1) : 0.0; /* a spot does not grow darker off its axis */
  }
  float near = node.falls_off > 0.5 ? 1.0 / max(max(square, radius_square), 1e-30) : 1.0;
  return node.brightness * facing * shining * near;
}

/* Nodes in whose sphere a point is say little about it: what is below them is looked at. The next node from `at` on that is
 * none of these, which `at` becomes. */
LightNode light_tree_part(inout int at, vec3 point)
{
  LightNode node = read_light_node(at);
  while (node.next > at + 1 && node.radius > distance(node.center, point)) {
    at++;
    node = read_light_node(at);
  }
  return node;
}

/* About what all lights together give, as far as can be told without looking at each. */
float light_tree_total(vec3 point, vec3 normal, bool around)
{
  int count = int(frame_light_node_count);
  float total = 0.0;
  for (int at = 0; at < count;) {
    LightNode node = light_tree_part(at, point);
    total += light_tree_importance(node, point, normal, around);
    at = node.next;
  }
  return total;
}

/* A light, and how probable it was; -1 where none gives anything. `u` in [0, 1) chooses; `total`: see above. */
int light_tree_pick(vec3 point, vec3 normal, bool around, float total, float u, out float probability)
{
  int count = int(frame_light_node_count);
  int index = -1;
  float left = u * total;
  probability = 0.0;
  for (int at = 0; at < count;) { /* the part of the tree into whose share `u` falls */
    LightNode node = light_tree_part(at, point);
    float importance = light_tree_importance(node, point, normal, around);
    bool found = importance > 0.0 && left < importance;
    if (importance > 0.0) { /* the last one where rounding leaves something over */
      index = at;
      u = min(left / importance, 0.9999999);
      probability = importance / total;
    }
    left -= importance;
    at = found ? count : node.next;
  }
  int light = -1;
  int end = 0;
  if (index >= 0) {
    LightNode top = read_light_node(index);
    light = top.light;
    end = top.next;
  }
  while (index >= 0 && index + 1 < end) { /* down to a leaf */
    LightNode first = read_light_node(index + 1);
    LightNode second = read_light_node(first.next);
    float of_first = light_tree_importance(first, point, normal, around);
    float both = of_first + light_tree_importance(second, point, normal, around);
    if (both <= 0.0) {
      return -1;
    }
    float share = of_first / both;
    bool goes_first = u < share;
    probability *= goes_first ? share : 1.0 - share;
    u = min(goes_first ? u / share : (u - share) / max(1.0 - share, 1e-30), 0.9999999);
    index = goes_first ? index + 1 : first.next;
    end = goes_first ? first.next : second.next;
    light = goes_first ? first.light : second.light;
  }
  return light;
}

/* Whether the lamps of a node may count as one: they are seen under a small angle, a smaller one where they shine to different
 * sides. */
bool light_tree_is_one(LightNode node, vec3 point)
{
  bool alike = node.cos_axis < -1.0 || node.cos_axis > 0.97;
  return node.radius <= (alike ? 1.0 : 0.4) * frame_light_cut_angle * distance(node.center, point);
}

/* The next node from `index` on whose lamps are asked as one, a single lamp often; false at the end of the lamps. */
bool light_tree_cut(inout int index, vec3 point, vec3 normal, bool around, out LightNode node)
{
  int end = int(frame_light_cut_end);
  node = read_light_node(min(index, end - 1));
  while (index < end) {
    node = read_light_node(index);
    bool dark = light_tree_importance(node, point, normal, around) <= 0.0;
    if (!dark && (node.next == index + 1 || light_tree_is_one(node, point))) {
      return true;
    }
    index = dark ? node.next : index + 1;
  }
  return false;
}

/* What a surface asks in one of its turns. */
struct LightChoice {
  int light;      /* -1: none */
  float weight;   /* what it gives counts so many times */
  bool is_many;   /* it stands for all lamps of `node` */
  LightNode node;
};

/* The light of turn `index` of the surface that is number `depth` on its path, `total` see above; where lights are not chosen by chance `index`
 * is that of a node, and becomes that of the last one that the light stands for. */
LightChoice light_tree_choose(inout int index, vec3 point, vec3 normal, bool around, float total, int depth)
{
  LightChoice choice;
  choice.light = -1;
  choice.weight = 1.0;
  choice.is_many = false;
  if (frame_sample >= 0.0) {
    float probability;
    int dimension = (depth * LIGHT_PICKS + index) * 2;
    float u = sampling_2d(sampling_pixel(PIXEL), int(frame_sample), dimension).x;
    u = (float(index) + u) / float(LIGHT_PICKS);
    choice.light = light_tree_pick(point, normal, around, total, u, probability);
    choice.weight = 1.0 / (float(LIGHT_PICKS) * max(probability, 1e-30));
  }
  else if (light_tree_cut(index, point, normal, around, choice.node)) {
    choice.light = choice.node.light;
    choice.is_many = choice.node.next > index + 1;
    index = choice.node.next - 1;
  }
  return choice;
}

/* From what arrives of one lamp of this color to what arrives of all in its node: it comes from their middle. */
vec3 light_tree_gathered(LightNode node, vec3 arriving, vec3 color, float range, vec3 point, out vec3 direction)
{
  vec3 to_lights = node.center - point;
  float square = max(dot(to_lights, to_lights), 1e-30);
  direction = to_lights / sqrt(square);
  float nearer = node.falls_off > 0.5 ? range * range / square : 1.0;
  return node.color * (nearer * optics_mean(arriving) / max(optics_mean(color), 1e-30));
}
