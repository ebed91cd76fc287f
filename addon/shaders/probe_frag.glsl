/* The probe as fragments. */
#include "probe_lib.glsl"

void main()
{
  out_color = probe_sample();
}
