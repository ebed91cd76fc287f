/* A node's reference: a = (low, leaf, unused, unused), answered by its parts and the joined index in two halves. */
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  int leaf = int(value.a.y);
  int index = JOIN_INDEX(int(value.a.x), LEAF_HIGH(leaf));
  out_color = vec4(float(LEAF_KIND(leaf)), float(LEAF_COUNT(leaf)), float(index & 65535), float(index >> 16));
  int root = JOIN_INDEX(int(value.b.x), LEAF_HIGH(LEAF_INNER(int(value.b.y))));
  out_root = vec4(float(LEAF_COUNT(LEAF_INNER(int(value.b.y)))), 0.0, float(root & 65535), float(root >> 16));
}
