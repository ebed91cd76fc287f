/* Lights: what comes from the middle of one, or from a point of it that is chosen. */
#include "ray_lib.glsl"
#include <light>
#ifdef HAS_LIGHT_SHAPES
#include <light_shape>
#include "sampling_lib.glsl"
#endif
#ifdef HAS_EMITTERS
#include "emitter_lib.glsl"
#endif

#define LIGHT_POINT 0
#define LIGHT_CONSTANT 1
#define LIGHT_SUN 2
#define LIGHT_SPOT 3
#define LIGHT_RECTANGLE 4
#define LIGHT_ELLIPSE 5
#define LIGHT_TRIANGLE 6
#define LIGHT_ELLIPSOID 7
#define LIGHT_TUBE 8

/* `light.emitter` of a surface that glows not everywhere the same: its light is what the shadow ray sees at its end. */
#define EMITTER_VARIES 2

/* What arrives at a point if nothing is in the way, from a light without extent: the radiance that a white diffuse surface
 * facing the light returns, the unit direction towards the light and its distance. */
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
  return light.kind == LIGHT_CONSTANT ? light.color : light.color / max(range * range, 1e-30);
}

#ifdef HAS_LIGHT_SHAPES
/* About how densely a light is asked in the direction of a point of it that is `range` away, times 2 pi; `seen_area` says what it
 * is, and how often it is chosen. Both ways to find it, see `sampling_weight`, take this for the density. */
float light_density(float range, float seen_area)
{
  return min(TWO_PI * range * range / max(seen_area, 1e-30), SAMPLING_ALWAYS);
}

/* The same of lights with extent: from the middle of a light it is what all of the light gives a surface that faces it (near
 * an area light, a disc of its size); from a point of it, chosen by `u`, its mean over `u` is what the light gives.
 * `light.position` becomes where the light comes from. */

/* Move a sun within its disc. */
vec3 light_of_sun(inout Light light, LightShape shape, vec2 u)
{
  float sine = sin(0.5 * shape.radius);
  float height = 2.0 * sine * sine;
  light.position = sampling_cone(light.position, height, u);
  return light.color * (2.0 / (2.0 - height)); /* solid angle over projected solid angle, 2 pi height / (pi sin^2) */
}

/* Cycles' cone of a spot: smooth in the cosine, in a space where the cone is round. */
float light_cone(LightShape shape, vec3 from_light)
{
  vec3 local = vec3(dot(shape.axis_x, from_light), dot(shape.axis_y, from_light), dot(shape.axis_z, from_light));
  float inside = clamp((local.z / max(length(local), 1e-30) - shape.edge) * shape.slope, 0.0, 1.0);
  return inside * inside * (3.0 - 2.0 * inside);
}

/* A ball that gives off the same everywhere, or a soft one: its middle disc, which faces each point that it lights. Inside
 * the ball there is light from all sides, and of a spot no cone. */
vec3 light_of_ball(inout Light light, LightShape shape, vec3 point, bool sampled, vec2 u, out vec3 direction, out float range)
{
  vec3 center = light.position;
  vec3 radiance = light_at(light, point, direction, range);
  float radius = shape.radius;
  float square = range * range;
  bool soft = shape.soft > 0.5;
  bool inside = range <= radius && !soft;
  if (!sampled) {
    radiance = light.color / max(soft ? square + radius * radius : max(square, radius * radius), 1e-30);
  }
  else if (radius > 0.0 && range > 0.0) {
    vec3 axis = direction;
    if (soft) {
      light.position = center + radius * sampling_around(axis, vec3(sampling_disc(u), 0.0));
    }
    else {
      float sine_square = radius * radius / square;
      float height = inside ? 2.0 : sine_square / (1.0 + sqrt(1.0 - sine_square));
      direction = sampling_cone(axis, height, u);
      float cosine = dot(direction, axis);
      float half_chord = sqrt(max(radius * radius - square * (1.0 - cosine * cosine), 0.0));
      float t = range * cosine + (inside ? half_chord : -half_chord);
      light.position = center + radius * normalize(t * direction - range * axis);
      radiance = light.color * (2.0 * height / (radius * radius));
    }
    vec3 to_light = light.position - point;
    float distance_before = range;
    range = length(to_light);
    direction = to_light / max(range, 1e-30);
    if (soft) {
      radiance = light.color * distance_before / max(range * range * range, 1e-30);
    }
  }
  return light.kind == LIGHT_SPOT && !inside ? radiance * light_cone(shape, -direction) : radiance;
}

/* The cosine of what leaves a flat light towards a point seen from it, 0 on a side that does not shine. */
float light_facing(Light light, float cosine)
{
  return light.sides == 0.0 ? abs(cosine) : max(light.sides * cosine, 0.0);
}

/* A rectangle, an ellipse or a triangle. With a spread it is seen through a grid of slats, which hides of it the
 * more the farther one looks off its axis, all beyond half the spread (as Cycles has it): a place on the light is chosen
 * among what the slats may show, what is within `reach` of the point's foot on the light. */
vec3 light_of_area(inout Light light, LightShape shape, vec3 point, bool sampled, vec2 u, out vec3 direction, out float range)
{
  bool round = light.kind == LIGHT_ELLIPSE;
  vec2 size = vec2(length(shape.axis_x), length(shape.axis_y)); /* half sides, semi-axes */
  vec2 place = !sampled ? vec2(0.0) : round ? sampling_disc(u) : 2.0 * u - 1.0;
#ifdef HAS_EMITTERS
  if (light.kind == LIGHT_TRIANGLE) {
    place = u.x + u.y > 1.0 ? 1.0 - u : u;
  }
#endif
  float share = 1.0; /* of the light among which was chosen, times what the slats show of it if they are not looked at */
  if (shape.spread > 0.0) {
    vec3 offset = point - light.position;
    vec2 foot = vec2(dot(offset, shape.axis_x), dot(offset, shape.axis_y)) / (size * size);
    vec2 reach = max(dot(offset, shape.axis_z), 0.0) / (shape.spread * size);
    vec2 lower = clamp(foot - reach, -1.0, 1.0);
    vec2 upper = clamp(foot + reach, -1.0, 1.0);
    place = mix(lower, upper, sampled ? u : vec2(0.5));
    share = 0.25 * (upper.x - lower.x) * (upper.y - lower.y);
    if (round) {
      share = sampled && dot(place, place) > 1.0 ? 0.0 : share * (8.0 / TWO_PI);
    }
    if (!sampled) { /* their mean is pi / 12 where all that is within reach is light, and that at its middle where little is */
      share = min(share, 1.0) * mix(1.0, TWO_PI / 24.0, min(share / max(reach.x * reach.y, 1e-30), 1.0));
    }
  }
  light.position += place.x * shape.axis_x + place.y * shape.axis_y;
  vec3 to_light = light.position - point;
  range = length(to_light);
  direction = to_light / max(range, 1e-30);
  float cosine = light_facing(light, -dot(direction, shape.axis_z));
  float shown = max(1.0 - shape.spread * length(cross(direction, shape.axis_z)) / max(cosine, 1e-30), 0.0);
  float near = sampled ? 0.0 : share * size.x * size.y * (round ? 1.0 : 8.0 / TWO_PI); /* area / pi */
  return light.color * (share * shown * cosine / max(range * range + near, 1e-30));
}

vec3 light_shaped_at(inout Light light, int index, vec3 point, bool sampled, vec2 u, out vec3 direction, out float range)
{
  LightShape shape = read_light_shape(index);
  vec3 radiance;
  if (light.kind == LIGHT_SUN) {
    radiance = sampled ? light_of_sun(light, shape, u) : light.color;
    direction = light.position;
    range = 1e30;
    return radiance;
  }
  if (light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT) {
    radiance = light_of_ball(light, shape, point, sampled, u, direction, range);
  }
  else if (light.kind == LIGHT_CONSTANT) {
    return light_at(light, point, direction, range);
  }
#ifdef HAS_EMITTERS
  else if (light.kind >= LIGHT_ELLIPSOID) {
    vec3 normal;
    float area = 0.0;
    if (light.kind == LIGHT_TUBE) {
      area = emitter_tube(shape, u, light.position, normal);
    }
    else {
      area = emitter_ellipsoid(shape, point, light.sides < 0.0, u, light.position, normal);
    }
    vec3 to_light = light.position - point;
    range = length(to_light);
    direction = to_light / max(range, 1e-30);
    radiance = light.color * (area * light_facing(light, -dot(direction, normal)) / max(range * range, 1e-30));
  }
#endif
  else {
    radiance = light_of_area(light, shape, point, sampled, u, direction, range);
  }
  return shape.falls_off > 0.5 ? radiance : radiance * range * range;
}
#endif
