/* A uniform grid over spheres and cylinders, see `engine/grid.py`: the cells on a ray's way, one after the other.
 *
 * Each turn takes a step to the next cell where the one at hand is done, and tests one item where there is one: where pixels
 * are worked on in step, none waits for another's full cell. Around the cells lies a layer of others that end the way. */
#include "ray_lib.glsl"
#include "primitive_lib.glsl"
#include <grid>
#include <grid_cell>
#include <grid_item>
#include <grid_reference>

float grid_item_hit(GridItem item, Ray ray, float t_max)
{
#ifdef HAS_GRID_CYLINDERS
  return quadric_side_hit(item.base, item.axis, item.height, abs(item.radius), 0.0, item.radius > 0.0, ray, t_max);
#else
  Sphere sphere;
  sphere.center = item.base;
  sphere.radius = item.radius;
  return sphere_hit(sphere, ray, t_max);
#endif
}

/* Nearest hit in (0, hit.t), or the first one found when `any_hit`, in the grid whose record is at this node's number. */
void grid_hit(int number, Ray ray, bool any_hit, inout Hit hit)
{
  Grid grid = read_grid(number);
  vec3 origin = (ray.origin - grid.lower) * grid.per_size; /* from here on a cell is 1 long */
  vec3 direction = ray.direction * grid.per_size;
  vec3 inverse = ray_inverse(direction);
  vec3 t_lower = -origin * inverse;
  vec3 t_upper = (grid.resolution - origin) * inverse;
  vec3 t_first = min(t_lower, t_upper);
  vec3 t_last = max(t_lower, t_upper);
  float t_enter = max(max(t_first.x, t_first.y), max(t_first.z, 0.0));
  if (!(t_enter < min(min(t_last.x, t_last.y), min(t_last.z, hit.t)))) { /* nor with NaN, here and below */
    return;
  }
  /* From there on, so that steps keep their digits however far the ray has come. */
  vec3 entry = origin + t_enter * direction;
  float t_left = hit.t - t_enter;
  float t = 0.0; /* where the ray is in the next cell */
  vec3 place = clamp(floor(entry), vec3(0.0), grid.resolution - 1.0);
  vec3 upwards = step(vec3(0.0), inverse);
  vec3 t_next = (place + upwards - entry) * inverse; /* where it leaves that cell along each axis */
  vec3 t_step = abs(inverse);
  int cell = 4 * (number + 1) + int(place.x) + 1 + (int(place.y) + 1) * grid.row + (int(place.z) + 1) * grid.layer;
  ivec3 stride = ivec3(1, grid.row, grid.layer) * (2 * ivec3(upwards) - 1);
  int items = 2 * (number + 1) + grid.first_item;

  int found = -1;
  int item = 0;
  int end = 0; /* of the items in the cell at hand */
  while (true) {
    if (item == end) {
      if (!(t < t_left)) {
        break;
      }
      GridCell now = read_grid_cell(cell);
      item = now.first;
      end = now.end;
      if (item > end) { /* beyond the last cell */
        break;
      }
      t = min(t_next.x, min(t_next.y, t_next.z));
      cell += t_next.x == t ? stride.x : 0; /* through an edge it takes both steps */
      cell += t_next.y == t ? stride.y : 0;
      cell += t_next.z == t ? stride.z : 0;
      t_next.x += t_next.x == t ? t_step.x : 0.0;
      t_next.y += t_next.y == t ? t_step.y : 0.0;
      t_next.z += t_next.z == t ? t_step.z : 0.0;
    }
    if (item < end) {
      float t_item = grid_item_hit(read_grid_item(items + item), ray, hit.t);
      if (t_item < hit.t) {
        hit.t = t_item;
        t_left = t_item - t_enter;
        found = item;
        if (any_hit) {
          break;
        }
      }
      item++;
    }
  }
  if (found >= 0) {
    int reference = read_grid_reference(4 * (number + 1) + grid.first_reference + found).reference;
    hit.kind = reference & 1;
    hit.index = reference >> 1;
  }
}
