/* The light that b.w chooses for the point a.xyz with the normal b.xyz, light from behind counting with a.w, and how probable
 * it was; the importance of node TEST_INDEX for a point that is the same for all. */
#include "light_tree_lib.glsl"
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  float probability;
  float total = light_tree_total(value.a.xyz, value.b.xyz, value.a.w > 0.5);
  int light = light_tree_pick(value.a.xyz, value.b.xyz, value.a.w > 0.5, total, value.b.w, probability);
  out_pick = vec4(float(light), probability, 0.0, 0.0);
  int index = min(TEST_INDEX, int(frame_light_node_count) - 1);
  out_importance = vec4(light_tree_importance(read_light_node(index), value.a.xyz, value.b.xyz, value.a.w > 0.5));
  LightNode node;
  int at = 0;
  vec3 color = vec3(0.0);
  int rays = 0;
  while (light_tree_cut(at, value.a.xyz, value.b.xyz, value.a.w > 0.5, node)) {
    color += node.color;
    rays++;
    at = node.next;
  }
  out_cut = vec4(color, float(rays));
}
