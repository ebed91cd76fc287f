/* The node Sky Texture: a table by direction, and the sun's disc in front of it. See `engine/sky.py`. */
#include "quadric_lib.glsl"

/* Height of a direction above the horizon as an angle. As in Cycles nothing is made of a vector that is no unit. */
float sky_elevation(vec3 direction)
{
  return asin(clamp(direction.z, -1.0, 1.0));
}

/* Where a direction lies in a table of so many rows. Its middle column is towards the sun, whose angle about -Z from +Y is
   `rotation`; rows are close to each other at the horizon. */
vec2 sky_place(vec3 direction, float rotation, float rows)
{
  float azimuth = direction.x == 0.0 && direction.y == 0.0 ? 0.0 : atan(direction.x, direction.y);
  float elevation = sky_elevation(direction);
  float row = 0.5 + 0.5 * sign(elevation) * sqrt(abs(elevation) * (4.0 / TWO_PI));
  return vec2(0.5 + (azimuth - rotation) / TWO_PI, clamp(row, 0.5 / rows, 1.0 - 0.5 / rows));
}

/* Radiance of a `sky` with the sun's disc, seen under `half_angle` from its middle to its edge, which darkens towards
   the edge; `lower` and `upper` at its lowest and highest point. Below `horizon`, an elevation, the earth hides it.
   `before`: how much of the sky is seen before the disc. */
vec3 sky_with_sun(
    vec3 sky, vec3 direction, vec3 sun, float half_angle, float horizon, vec3 lower, vec3 upper, float before)
{
  float angle = 2.0 * atan(length(direction - sun), length(direction + sun));
  float elevation = sky_elevation(direction);
  if (angle >= half_angle || elevation <= horizon) {
    return sky;
  }
  float height = 0.5 + 0.5 * (elevation - sky_elevation(sun)) / half_angle;
  float share = angle / half_angle;
  return sky * before + mix(lower, upper, height) * (0.4 + 0.6 * sqrt(1.0 - share * share));
}
