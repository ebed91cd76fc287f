/* Points of curved surfaces that glow, evenly by area: what stands for the area around a point is returned. `place` is the
 * middle of the surface and becomes the point; `normal` is unit, outward. An affine map of the unit shape is all that is known
 * of a surface. Balls and what is flat are lights of other kinds. */
#include "sampling_lib.glsl"
#include <light_shape>

/* The side of a cylinder or cone of axis_z, round about axis_x and axis_y at its wider end, where it begins; on it every place
 * is as likely as its circle is wide. */
float emitter_tube(LightShape shape, vec2 u, inout vec3 place, out vec3 normal)
{
  float k = shape.taper;
  float width = sqrt(mix(1.0, k * k, u.x));
  float height = k < 0.9999 ? (1.0 - width) / (1.0 - k) : u.x;
  float angle = TWO_PI * u.y;
  vec3 outward = cos(angle) * shape.axis_x + sin(angle) * shape.axis_y;
  vec3 around = cos(angle) * shape.axis_y - sin(angle) * shape.axis_x;
  place += width * outward + height * shape.axis_z;
  vec3 area = cross(around, shape.axis_z + (k - 1.0) * outward);
  float size = length(area);
  normal = area / max(size, 1e-30);
  return 0.5 * TWO_PI * (1.0 + k) * size;
}

/* An ellipsoid: of the unit sphere that is seen so, the cap that a point sees; all of it from inside and if `inner`, when the
 * inside alone is there to be seen. */
float emitter_ellipsoid(LightShape shape, vec3 point, bool inner, vec2 u, inout vec3 place, out vec3 normal)
{
  vec3 face_x = cross(shape.axis_y, shape.axis_z);
  vec3 face_y = cross(shape.axis_z, shape.axis_x);
  vec3 face_z = cross(shape.axis_x, shape.axis_y);
  vec3 offset = point - place;
  vec3 local = vec3(dot(offset, face_x), dot(offset, face_y), dot(offset, face_z)) / dot(shape.axis_x, face_x);
  float range = length(local);
  float height = range > 1.0 && !inner ? 1.0 - 1.0 / range : 2.0;
  vec3 at = sampling_cone(range > 0.0 ? local / range : vec3(0.0, 0.0, 1.0), height, u);
  place += at.x * shape.axis_x + at.y * shape.axis_y + at.z * shape.axis_z;
  vec3 area = at.x * face_x + at.y * face_y + at.z * face_z;
  float size = length(area);
  normal = area / max(size, 1e-30);
  return TWO_PI * height * size;
}
