/* The probe as a compute program. */
#include "probe_lib.glsl"

void main()
{
  ivec2 place = ivec2(PIXEL);
  if (place.x >= tile.z || place.y >= tile.w) {
    return;
  }
  imageStore(out_color_image, place, imageLoad(out_color_image, place) + probe_sample());
}
