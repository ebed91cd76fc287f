/* What nodes ask of the ray and of the angle under which it comes. */
#include "coordinate_nodes_lib.glsl"
#include "optics_lib.glsl"

vec3 input_true_normal(Point point)
{
  return point.true_normal;
}

float input_backfacing(Point point)
{
  return point.backfacing ? 1.0 : 0.0;
}

/* Whether the ray is of one of the kinds whose bits are given, see `RAY_CAMERA`. */
float input_ray_is(Point point, int kinds)
{
  return (point.ray_kind & kinds) != 0 ? 1.0 : 0.0;
}

#ifdef HAS_LIGHT_PATH
float input_ray_length(Point point)
{
  return point.ray_length;
}

/* How often light has been scattered on the way: 0 for the eye's ray; a shadow ray is a step of its own. */
float input_ray_depth(Point point)
{
  bool is_shadow = (point.ray_kind & RAY_SHADOW) != 0;
  return float(point.ray_depth - (is_shadow ? 0 : 1));
}

/* How many surfaces on the way did not bend it. */
float input_transparent_depth(Point point)
{
  return float(point.passed);
}
#endif

/* Of a point in a space, in world coordinates. */
vec3 input_point_position(vec4 place, vec4 x, vec4 y, vec4 z)
{
  return coordinate_from_space(place.xyz, x, y, z);
}

/* Of a length in a space, in the world: its mean, as Cycles takes it. */
float input_point_radius(float radius, vec4 x, vec4 y, vec4 z)
{
  return length(coordinate_vector_from_space(vec3(radius * 0.57735027), x, y, z));
}

float input_dot(vec3 a, vec3 b)
{
  return dot(a, b);
}

#ifdef HAS_GRADIENTS
#ifdef HAS_ATTRIBUTES
/* Of a strand the normal that faces the ray: its weights grow along it. */
vec3 input_strand_normal(Point point)
{
  vec3 axis = coordinate_unit(point.surface.gradient_first);
  return coordinate_unit(point.incoming - dot(point.incoming, axis) * axis);
}
#endif
#endif

/* Fresnel's reflectance of a smooth dielectric. */
float input_fresnel(Point point, vec3 normal, float ior)
{
  float eta = max(ior, 1e-5);
  float cos_t;
  return optics_fresnel(min(abs(dot(point.incoming, normal)), 1.0), point.backfacing ? eta : 1.0 / eta, cos_t);
}

/* The two outputs of Layer Weight. */
void input_layer_weight(Point point, vec3 normal, float blend, out float fresnel, out float facing)
{
  float eta = max(1.0 - blend, 1e-5);
  float cosine = min(abs(dot(point.incoming, normal)), 1.0);
  float cos_t;
  fresnel = optics_fresnel(cosine, point.backfacing ? 1.0 / eta : eta, cos_t);
  float bend = clamp(blend, 0.0, 1.0 - 1e-5);
  facing = 1.0 - pow(cosine, bend < 0.5 ? 2.0 * bend : 0.5 / (1.0 - bend));
}
