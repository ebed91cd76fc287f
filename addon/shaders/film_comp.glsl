/* Adds a sample of the path tracer to each pixel of the film: the entry whose pixels are invocations. */
#include "trace_lib.glsl"

void main()
{
  ivec2 place = ivec2(PIXEL);
  if (place.x >= tile.z || place.y >= tile.w) {
    return;
  }
  Traced traced = trace_sample();
  imageStore(out_color_image, place, imageLoad(out_color_image, place) + traced.color);
#ifdef HAS_OUTLINES
  imageStore(out_guide_image, place, imageLoad(out_guide_image, place) + traced.guide);
#endif
#ifdef COUNT_RAYS
  imageStore(out_rays_image, place, imageLoad(out_rays_image, place) + traced.rays);
  imageStore(out_dropped_image, place, imageLoad(out_dropped_image, place) + traced.dropped);
#endif
}
