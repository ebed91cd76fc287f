/* The triangle: paper 3.1.5 and 3.2.2, decided by edge functions so that no ray slips between two neighbours. */
#include "ray_lib.glsl"
#include <triangle>
#include <triangle_surface>

/* A vertex as the ray sees it: two coordinates across the ray and the third along it. What a vertex becomes depends on
 * nothing but the ray, so triangles that share it agree on it. (The idea is Woop et al. 2013, Watertight Ray/Triangle
 * Intersection; the basis is that of Duff et al. 2017, Building an Orthonormal Basis, Revisited.) */
vec3 triangle_seen(vec3 corner, Ray ray)
{
  vec3 offset = corner - ray.origin;
  vec3 d = ray.direction;
  float side = d.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (side + d.z);
  float b = d.x * d.y * a;
  return vec3(dot(offset, vec3(1.0 + side * d.x * d.x * a, side * b, -side * d.x)),
              dot(offset, vec3(b, side + d.y * d.y * a, -d.y)), dot(offset, d));
}

/* Twice the signed area between the ray and an edge from a to b. Taken in one order of the two ends, so that the triangle
 * on the other side of the edge gets exactly the opposite, with fused multiplications too. */
float triangle_edge(vec3 a, vec3 b)
{
  bool ordered = a.x < b.x || (a.x == b.x && a.y < b.y);
  vec2 first = ordered ? a.xy : b.xy;
  vec2 last = ordered ? b.xy : a.xy;
  float area = first.x * last.y - first.y * last.x;
  return ordered ? area : -area;
}

/* Areas opposite to p0, p1, p2, of one sign where the ray meets the triangle; `along`: the vertices' distances along it. */
vec3 triangle_areas(Triangle triangle, Ray ray, out vec3 along)
{
  vec3 a = triangle_seen(triangle.p0, ray);
  vec3 b = triangle_seen(triangle.p1, ray);
  vec3 c = triangle_seen(triangle.p2, ray);
  along = vec3(a.z, b.z, c.z);
  return vec3(triangle_edge(b, c), triangle_edge(c, a), triangle_edge(a, b));
}

/* How many roundings of the vertices' coordinates the plane's equation makes of each, and the edges' cross product: many for
 * a sliver, whose normal its rounded edges hardly tell. */
vec3 triangle_spread(vec3 e1, vec3 e2)
{
  return abs(cross(e1, e2)) + abs(e1.yzx * e2.zxy) + abs(e1.zxy * e2.yzx);
}

/* Nearest t in (0, t_max), else t_max. Of the distance from the plane and the weighted mean of the vertices' distances it is
 * the one that rounding harms less: the plane's for a large floor, the mean's for a sliver. */
float triangle_hit(Triangle triangle, Ray ray, float t_max)
{
  vec3 along;
  vec3 areas = triangle_areas(triangle, ray, along);
  float lowest = min(areas.x, min(areas.y, areas.z));
  float highest = max(areas.x, max(areas.y, areas.z));
  float sum = areas.x + areas.y + areas.z;
  if ((lowest < 0.0 && highest > 0.0) || sum == 0.0 || (triangle.one_sided > 0.5 && sum > 0.0)) {
    return t_max;
  }
  vec3 e1 = triangle.p1 - triangle.p0;
  vec3 e2 = triangle.p2 - triangle.p0;
  vec3 to_plane = triangle.p0 - ray.origin;
  vec3 normal = cross(e1, e2);
  float facing = dot(normal, ray.direction);
  if (facing == 0.0) {
    return t_max;
  }
  vec3 reach = abs(along);
  bool by_plane = dot(triangle_spread(e1, e2), abs(to_plane)) < max(reach.x, max(reach.y, reach.z)) * abs(facing);
  float t = by_plane ? dot(normal, to_plane) / facing : dot(areas / sum, along);
  return (t > 0.0 && t < t_max) ? t : t_max;
}

/* From a point of the triangle to the smooth surface: the mean of where the planes across the vertex normals lie over the
 * point, 0 where they lie under it. `facing` < 0: over is where the normals point to, else the other side. (Hanika 2021,
 * Hacking the Shadow Terminator, Ray Tracing Gems II, chapter 4.) */
vec3 triangle_lift(Triangle triangle, TriangleSurface info, vec3 weights, vec3 position, float facing)
{
  float side = facing < 0.0 ? 1.0 : -1.0;
  float h0 = side * min(side * dot(position - triangle.p0, info.n0), 0.0);
  float h1 = side * min(side * dot(position - triangle.p1, info.n1), 0.0);
  float h2 = side * min(side * dot(position - triangle.p2, info.n2), 0.0);
  return -(weights.x * h0) * info.n0 - (weights.y * h1) * info.n1 - (weights.z * h2) * info.n2;
}

Surface triangle_surface(Triangle triangle, TriangleSurface info, Ray ray, float t)
{
  vec3 along;
  vec3 areas = triangle_areas(triangle, ray, along);
  vec3 weights = areas / (areas.x + areas.y + areas.z);
  vec3 position = weights.x * triangle.p0 + weights.y * triangle.p1 + weights.z * triangle.p2;
  vec3 e1 = triangle.p1 - triangle.p0;
  vec3 e2 = triangle.p2 - triangle.p0;
  vec3 normal = cross(e1, e2);
  float area = length(normal);
  normal /= area;
  vec3 smooth_normal = weights.x * info.n0 + weights.y * info.n1 + weights.z * info.n2;
  float size = length(smooth_normal);
  vec3 shading_normal = size > 0.0 ? smooth_normal / size : normal;
  /* Vertex normals say which side is outside when they disagree with the order of the vertices only at single points. */
  if (dot(shading_normal, normal) < 0.0) {
    shading_normal = -shading_normal;
  }
  vec2 uv = weights.x * vec2(info.u0, info.v0) + weights.y * info.uv1 + weights.z * info.uv2;
  vec3 extent = max(abs(triangle.p0), max(abs(triangle.p1), abs(triangle.p2)));
  Surface surface = ray_make_surface(position, normal, shading_normal, uv, info.material,
                 min(ray_flat_error(triangle_spread(e1, e2) / area, extent), ray_error(extent, 0.0)));
  float facing = dot(shading_normal, smooth_normal) * dot(normal, ray.direction);
  surface.lift = triangle_lift(triangle, info, weights, position, facing);
#ifdef HAS_GRADIENTS
  vec3 gradient_first = cross(e2, normal) / area;
  vec3 gradient_second = cross(normal, e1) / area;
  surface.gradient_u = (info.uv1.x - info.u0) * gradient_first + (info.uv2.x - info.u0) * gradient_second;
  surface.gradient_v = (info.uv1.y - info.v0) * gradient_first + (info.uv2.y - info.v0) * gradient_second;
#endif
#ifdef HAS_ATTRIBUTES
  surface.weights = weights.yz;
#ifdef HAS_GRADIENTS
  surface.gradient_first = gradient_first;
  surface.gradient_second = gradient_second;
#endif
#endif
  return surface;
}
