/* Coordinates that textures take, and the spaces that vectors of nodes are in.
 *
 * A space is three vec4: a row each of the matrix from world to its own coordinates, and a component each of the place of
 * its origin. Lengths are measured from that place, so that they keep their digits far from the world's origin. */
#include "point_lib.glsl"

vec3 coordinate_world(Point point)
{
  return frame_world_origin + point.position;
}

/* A point in a space. */
vec3 coordinate_in_space(Point point, vec4 x, vec4 y, vec4 z)
{
  vec3 offset = point.position - (vec3(x.w, y.w, z.w) - frame_world_origin);
  return vec3(dot(x.xyz, offset), dot(y.xyz, offset), dot(z.xyz, offset));
}

/* The same of a place in world coordinates. */
vec3 coordinate_to_space(vec3 place, vec4 x, vec4 y, vec4 z)
{
  vec3 offset = place - vec3(x.w, y.w, z.w);
  return vec3(dot(x.xyz, offset), dot(y.xyz, offset), dot(z.xyz, offset));
}

vec3 coordinate_vector_to_space(vec3 v, vec4 x, vec4 y, vec4 z)
{
  return vec3(dot(x.xyz, v), dot(y.xyz, v), dot(z.xyz, v));
}

vec3 coordinate_vector_from_space(vec3 v, vec4 x, vec4 y, vec4 z)
{
  vec3 across = cross(y.xyz, z.xyz);
  float volume = dot(x.xyz, across);
  vec3 moved = v.x * across + v.y * cross(z.xyz, x.xyz) + v.z * cross(x.xyz, y.xyz);
  return volume != 0.0 ? moved / volume : v;
}

vec3 coordinate_from_space(vec3 v, vec4 x, vec4 y, vec4 z)
{
  return coordinate_vector_from_space(v, x, y, z) + vec3(x.w, y.w, z.w);
}

/* Generated coordinates of a place in the object's space: of what is deformed they are the offset alone. */
vec3 coordinate_in_box(vec3 place, vec4 scale, vec4 offset)
{
  return place * scale.xyz + offset.xyz;
}

float coordinate_length(vec3 v)
{
  return length(v);
}

/* Unit, or 0. */
vec3 coordinate_unit(vec3 v)
{
  float size = length(v);
  return size > 0.0 ? v / size : vec3(0.0);
}

/* Normals go with the transposed inverse. */
vec3 coordinate_normal_to_space(vec3 n, vec4 x, vec4 y, vec4 z)
{
  vec3 across = cross(y.xyz, z.xyz);
  float side = dot(x.xyz, across) < 0.0 ? -1.0 : 1.0;
  return coordinate_unit(side * vec3(dot(n, across), dot(n, cross(z.xyz, x.xyz)), dot(n, cross(x.xyz, y.xyz))));
}

vec3 coordinate_normal_from_space(vec3 n, vec4 x, vec4 y, vec4 z)
{
  return coordinate_unit(n.x * x.xyz + n.y * y.xyz + n.z * z.xyz);
}

/* In the camera's axes: to the right, up, and away from it. */
vec3 coordinate_vector_to_camera(vec3 v)
{
  return vec3(dot(v, frame_camera_right), dot(v, frame_camera_up), dot(v, frame_camera_forward));
}

vec3 coordinate_vector_from_camera(vec3 v)
{
  return v.x * frame_camera_right + v.y * frame_camera_up + v.z * frame_camera_forward;
}

vec3 coordinate_camera(Point point)
{
  return coordinate_vector_to_camera(point.position - frame_camera_origin);
}

vec3 coordinate_to_camera(vec3 place)
{
  return coordinate_vector_to_camera((place - frame_world_origin) - frame_camera_origin);
}

vec3 coordinate_from_camera(vec3 v)
{
  return coordinate_vector_from_camera(v) + frame_camera_origin + frame_world_origin;
}

/* In the picture, from 0 to 1, of coordinates in the camera's axes. */
vec3 coordinate_window(vec3 camera)
{
  vec2 window = frame_orthographic > 0.5 ? camera.xy : camera.xy / camera.z;
  return vec3((window - frame_window.xy) * frame_window.zw, 0.0);
}

/* The same where a ray looks at the sky. */
vec3 coordinate_sky_window(Point point)
{
  vec3 camera = coordinate_vector_to_camera(point.position);
  if (frame_orthographic > 0.5 && point.ray_kind == RAY_CAMERA) {
    camera.xy = PIXEL * frame_raster.xy + frame_raster.zw;
  }
  return coordinate_window(camera);
}

vec3 coordinate_reflection(Point point)
{
  return 2.0 * dot(point.normal, point.incoming) * point.normal - point.incoming;
}

/* Of what is around an axis of the generated coordinates (0, 1 or 2), as a normal of the object's space. */
vec3 coordinate_radial(vec3 generated, int axis)
{
  vec3 from_middle = generated - 0.5;
  if (axis == 0) {
    return vec3(0.0, -from_middle.z, from_middle.y);
  }
  return axis == 1 ? vec3(-from_middle.z, 0.0, from_middle.x) : vec3(-from_middle.y, from_middle.x, 0.0);
}

/* The unit vector along the surface that is nearest to a direction. */
vec3 coordinate_along(Point point, vec3 direction)
{
  return coordinate_unit(direction - dot(direction, point.normal) * point.normal);
}

#ifdef HAS_ATTRIBUTES
/* Of a triangle the weights of its first and its second vertex. */
vec3 coordinate_parametric(Point point)
{
  vec2 weights = point.surface.weights;
  return vec3(1.0 - weights.x - weights.y, weights.x, 0.0);
}
#endif
