/* Adds a sample of the path tracer to each pixel of the film: the entry whose pixels are fragments. */
#include "trace_lib.glsl"

void main()
{
  Traced traced = trace_sample();
  out_color = traced.color;
#ifdef HAS_OUTLINES
  out_guide = traced.guide;
#endif
#ifdef COUNT_RAYS
  out_rays = traced.rays;
  out_dropped = traced.dropped;
#endif
}
