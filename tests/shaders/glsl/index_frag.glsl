/* A node's reference: a = (first, leaf, first of an inner node, its high part), answered by its parts and the index in halves. */
#include <test_value>

void main()
{
  TestValue value = read_test_value(TEST_INDEX);
  int reference = REFERENCE(WHOLE(value.a.x), WHOLE(value.a.y));
  int index = REFERENCE_INDEX(reference);
  int leaf = LEAF_OF(reference);
  out_color = vec4(float(LEAF_KIND(leaf)), float(LEAF_COUNT(leaf)), float(index & 65535), float(index >> 16));
  int inner = REFERENCE(WHOLE(value.a.z), WHOLE(value.a.w));
  out_root = vec4(REFERENCE_IS_INNER(reference), REFERENCE_IS_INNER(inner), float(inner & 65535), float(inner >> 16));
}
