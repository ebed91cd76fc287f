/* What stands outside of the trees: the world's shapes of kinds of which there are few. Each ray tests them first. */
#include "primitive_lib.glsl"

#define OUTSIDE_TEST(KIND, read, test, place) \
  { \
    int first = JOIN_INDEX(int(place.x), int(place.y)); \
    PRIMITIVE_TESTS(KIND, read, test, first, int(place.z)) \
  }

void outside_hit(Ray ray, inout Hit hit)
{
#ifdef HAS_SPHERE_OUTSIDE
  OUTSIDE_TEST(KIND_SPHERE, read_sphere, sphere_hit, frame_outside_sphere)
#endif
#ifdef HAS_CYLINDER_OUTSIDE
  OUTSIDE_TEST(KIND_CYLINDER, read_cylinder, cylinder_hit, frame_outside_cylinder)
#endif
#ifdef HAS_CONE_OUTSIDE
  OUTSIDE_TEST(KIND_CONE, read_cone, cone_hit, frame_outside_cone)
#endif
#ifdef HAS_DISC_OUTSIDE
  OUTSIDE_TEST(KIND_DISC, read_disc, disc_hit, frame_outside_disc)
#endif
#ifdef HAS_TRIANGLE_OUTSIDE
  OUTSIDE_TEST(KIND_TRIANGLE, read_triangle, triangle_hit, frame_outside_triangle)
#endif
}
