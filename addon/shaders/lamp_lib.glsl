/* Lamps with extent as rays meet them. They give light and are in no ray's way, as in Cycles. */
#include "light_lib.glsl"

/* Where a ray meets a ball of light, or its middle disc, which faces where the ray comes from; negative: nowhere. */
float lamp_ball_hit(LightShape shape, vec3 to_center, vec3 direction)
{
  float along = dot(to_center, direction);
  float square = shape.radius * shape.radius;
  if (shape.soft > 0.5) {
    float t = dot(to_center, to_center) / max(along, 1e-30);
    vec3 across = t * direction - to_center;
    return dot(across, across) < square ? t : -1.0;
  }
  vec3 across = along * direction - to_center;
  float half_chord = sqrt(max(square - dot(across, across), 0.0));
  return half_chord > 0.0 ? along + (along > half_chord ? -half_chord : half_chord) : -1.0;
}

/* The same of the front of an area light. */
float lamp_area_hit(Light light, LightShape shape, vec3 to_center, vec3 direction)
{
  float facing = dot(direction, shape.axis_z);
  float t = dot(to_center, shape.axis_z) / min(facing, -1e-30);
  vec3 place = t * direction - to_center;
  vec2 square = vec2(dot(shape.axis_x, shape.axis_x), dot(shape.axis_y, shape.axis_y));
  vec2 part = vec2(dot(place, shape.axis_x), dot(place, shape.axis_y)) / square;
  float outside = light.kind == LIGHT_ELLIPSE ? dot(part, part) : max(abs(part.x), abs(part.y));
  return facing < 0.0 && outside < 1.0 ? t : -1.0;
}

/* The radiance of a lamp where a ray meets it after `range`; `range` is negative where the ray does not. */
vec3 lamp_radiance(Light light, LightShape shape, Ray ray, out float range)
{
  vec3 to_center = light.position - ray.origin;
  if (light.kind == LIGHT_SUN) {
    vec3 off = ray.direction - light.position;
    float sine = sin(0.5 * shape.radius);
    range = dot(off, off) < 4.0 * sine * sine ? 1e30 : -1.0;
    float area = sin(shape.radius);
    return light.color / max(area * area, 1e-30);
  }
  vec3 radiance;
  if (light.kind >= LIGHT_RECTANGLE) {
    range = lamp_area_hit(light, shape, to_center, ray.direction);
    float over_pi = light.kind == LIGHT_ELLIPSE ? 1.0 : 8.0 / TWO_PI;
    float area = length(cross(shape.axis_x, shape.axis_y)) * over_pi;
    float cosine = -dot(ray.direction, shape.axis_z);
    float shown = 1.0 - shape.spread * length(cross(ray.direction, shape.axis_z)) / max(cosine, 1e-30);
    radiance = light.color * (max(shown, 0.0) / area);
  }
  else {
    range = lamp_ball_hit(shape, to_center, ray.direction);
    radiance = light.color / max(shape.radius * shape.radius, 1e-30);
    bool inside = shape.soft < 0.5 && dot(to_center, to_center) < shape.radius * shape.radius;
    radiance *= light.kind == LIGHT_SPOT && !inside ? light_cone(shape, -ray.direction) : 1.0;
  }
  return shape.falls_off > 0.5 ? radiance : radiance * range * range;
}
