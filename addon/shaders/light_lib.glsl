/* Lights without extent. */
#include "ray_lib.glsl"
#include <light>

#define LIGHT_POINT 0
#define LIGHT_CONSTANT 1
#define LIGHT_SUN 2

/* What arrives at a point if nothing is in the way: the radiance that a white diffuse surface facing the light returns,
 * the unit direction towards the light and its distance. */
vec3 light_at(Light light, vec3 point, out vec3 direction, out float range)
{
  if (light.kind == LIGHT_SUN) {
    direction = light.position;
    range = 1e30;
    return light.color;
  }
  vec3 to_light = light.position - point;
  range = length(to_light);
  direction = to_light / max(range, 1e-30);
  return light.kind == LIGHT_POINT ? light.color / max(range * range, 1e-30) : light.color;
}
