/* The triangle: paper 3.1.5 and 3.2.2, decided by edge functions so that no ray slips between two neighbours. */
#include "ray_lib.glsl"
#include <triangle>
#include <triangle_surface>

/* Volumes spanned by the ray and each edge, opposite to p0, p1, p2: of one sign inside. Two triangles that share an edge get
 * exactly opposite values for it, since both see the same sum and opposite differences of its ends (the robust test of
 * Embree; Davidovic et al. 2012, 3D rasterization). */
vec3 triangle_edges(Triangle triangle, Ray ray)
{
  vec3 a = triangle.p0 - ray.origin;
  vec3 b = triangle.p1 - ray.origin;
  vec3 c = triangle.p2 - ray.origin;
  return vec3(dot(cross(c - b, c + b), ray.direction), dot(cross(a - c, a + c), ray.direction),
              dot(cross(b - a, b + a), ray.direction));
}

/* Nearest t in (0, t_max), else t_max: the weighted mean of the vertices' t. Unlike the distance from the plane, which a
 * sliver's normal hardly tells, it never leaves the triangle. The edges' sum is -2 times direction . normal. */
float triangle_hit(Triangle triangle, Ray ray, float t_max)
{
  vec3 edges = triangle_edges(triangle, ray);
  float lowest = min(edges.x, min(edges.y, edges.z));
  float highest = max(edges.x, max(edges.y, edges.z));
  float sum = edges.x + edges.y + edges.z;
  if ((lowest < 0.0 && highest > 0.0) || sum == 0.0 || (triangle.one_sided > 0.5 && sum < 0.0)) {
    return t_max;
  }
  vec3 along = vec3(dot(triangle.p0 - ray.origin, ray.direction), dot(triangle.p1 - ray.origin, ray.direction),
                    dot(triangle.p2 - ray.origin, ray.direction));
  float t = dot(edges / sum, along);
  return (t > 0.0 && t < t_max) ? t : t_max;
}

Surface triangle_surface(Triangle triangle, TriangleSurface info, Ray ray, float t)
{
  vec3 edges = triangle_edges(triangle, ray);
  vec3 weights = edges / (edges.x + edges.y + edges.z);
  vec3 position = weights.x * triangle.p0 + weights.y * triangle.p1 + weights.z * triangle.p2;
  vec3 normal = normalize(cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0));
  vec3 smooth_normal = weights.x * info.n0 + weights.y * info.n1 + weights.z * info.n2;
  float size = length(smooth_normal);
  vec3 shading_normal = size > 0.0 ? smooth_normal / size : normal;
  /* Vertex normals say which side is outside when they disagree with the order of the vertices only at single points. */
  if (dot(shading_normal, normal) < 0.0) {
    shading_normal = -shading_normal;
  }
  vec2 uv = weights.x * vec2(info.u0, info.v0) + weights.y * info.uv1 + weights.z * info.uv2;
  vec3 extent = max(abs(triangle.p0), max(abs(triangle.p1), abs(triangle.p2)));
  return Surface(position, normal, shading_normal, uv, info.material, ray_error(extent, 0.0));
}
