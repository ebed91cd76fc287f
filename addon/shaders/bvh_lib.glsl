/* The one traversal: nearest and any hit, the tree of instances and the trees of geometries.
 *
 * A node holds the boxes of both its children. A reference to a child is one integer, which says what kind and how many
 * primitives a leaf holds and where the first one lies. An instance is a leaf of the upper tree: its geometry is walked with
 * the ray in object space, on the same stack, until the stack is back where it stood. A geometry may have a grid in place of a
 * tree: a leaf that is all of it.
 *
 * Distances to boxes are compared by their bits, as integers: for positive floats the order is the same, a negative one is
 * less than any of them, and an integer's minimum is one instruction everywhere, where a float's may have to mind NaN. */
#include "ray_lib.glsl"
#include "primitive_lib.glsl"
#include "outside_lib.glsl"
#include <node>
#ifdef HAS_GRID
#include "grid_lib.glsl"
#endif
#ifdef HAS_INSTANCES
#include <instance>
#include <instance_surface>
#endif

#define BVH_MISS 0x7f7fffff /* bits of the largest float */

/* The ray's origin as the boxes' lower and upper faces see it, a few roundings apart: the intersection with a primitive
 * rounds by the largest coordinate, and a box that is told apart better than what it holds would lose hits at its faces.
 * Packing enlarges the boxes for the same reason. (Ize 2013, Robust BVH Ray Traversal, for all three axes.) */
#define BVH_RELATIVE_ERROR 4.8e-7

struct Slabs {
  vec3 origin_lower;
  vec3 origin_upper;
  vec3 inverse;
};

Slabs bvh_slabs(Ray ray)
{
  vec3 size = abs(ray.origin);
  vec3 error = vec3(BVH_RELATIVE_ERROR * max(size.x, max(size.y, size.z)));
  Slabs slabs;
  slabs.origin_lower = ray.origin + error;
  slabs.origin_upper = ray.origin - error;
  slabs.inverse = ray_inverse(ray.direction);
  return slabs;
}

/* Paper 3.2.7: where the segment t in (0, t_max] enters a box, 0 when it starts inside, BVH_MISS when it misses; all as bits.
 * Two negative distances swap places here, which is the same miss. */
int bvh_box_hit(vec3 lower, vec3 upper, Slabs slabs, int t_max)
{
  ivec3 t0 = floatBitsToInt((lower - slabs.origin_lower) * slabs.inverse);
  ivec3 t1 = floatBitsToInt((upper - slabs.origin_upper) * slabs.inverse);
  ivec3 first = min(t0, t1);
  ivec3 last = max(t0, t1);
  int enter = max(max(first.x, first.y), max(first.z, 0));
  int leave = min(min(last.x, last.y), min(last.z, t_max));
  return enter <= leave ? enter : BVH_MISS;
}

#ifdef HAS_INSTANCES
/* How much of the way to an instance's box the ray is taken there before it is seen in object space: not all of it, the box is
 * as tight as rounding allows. */
#define BVH_APPROACH 0.9375

/* The ray from `start` on in object space, its direction unit again; `scale` is what a length along it is multiplied by. The
 * nearer to the object it starts, the less its direction's rounding tells, and relative to the object's own origin nothing
 * large is subtracted: a stretched sphere's outline stays as exact as a sphere's, wherever it stands. */
Ray bvh_object_ray(Instance instance, InstanceSurface placed, Ray ray, float start, out float scale)
{
  vec3 place = vec3(placed.to_world_x.w, placed.to_world_y.w, placed.to_world_z.w);
  vec3 origin = (ray.origin - place) + start * ray.direction;
  vec3 direction = vec3(dot(instance.to_object_x.xyz, ray.direction), dot(instance.to_object_y.xyz, ray.direction),
                        dot(instance.to_object_z.xyz, ray.direction));
  scale = length(direction);
  return ray_make(vec3(dot(instance.to_object_x.xyz, origin), dot(instance.to_object_y.xyz, origin),
                       dot(instance.to_object_z.xyz, origin)), direction / scale, ray.kind);
}
#endif

/* The nearest hit in (0, t_max), or the first one found when `any_hit`; hit.kind is -1 when there is none. */
Hit bvh_traverse(Ray world_ray, float t_max, bool any_hit)
{
  Hit hit;
  hit.t = t_max;
  hit.kind = -1;
  hit.index = 0;
  hit.instance = -1;
  primitive_planes_hit(int(frame_plane_count), world_ray, hit);
  bool sees_shapes = world_ray.kind <= VISIBILITY_ALL; /* only instances and planes are catchers or in groups */
  if (sees_shapes) {
    outside_hit(world_ray, hit);
  }
  if (frame_root_count < 0.5 || (any_hit && hit.kind >= 0)) {
    return hit;
  }
#ifndef HAS_INSTANCES
  if (!sees_shapes) {
    return hit;
  }
#endif
#ifdef HAS_GRID_ALONE
  grid_hit(REFERENCE_INDEX(REFERENCE(int(frame_root), int(frame_root_high))), world_ray, any_hit, hit);
  return hit;
#else
  Ray ray = world_ray;
  Slabs slabs = bvh_slabs(ray);
  /* References that wait, but the last, which is in a register: it is at hand while memory is read. The place beyond the last
   * is written whether it counts or not: processors guess badly which lanes ask to write. */
  int stack[BVH_STACK_SIZE + 1];
#ifdef HAS_INSTANCES
  int stack_t[BVH_STACK_SIZE + 1]; /* where the ray enters their boxes */
#endif
  int top = 0;
  int next = 0;
  int reference = REFERENCE(int(frame_root), int(frame_root_high));
#ifdef HAS_INSTANCES
  int next_t = 0;
  int instance = -1;
  int instance_top = -1; /* where the stack stood when the instance was entered */
  int enters = 0;        /* where the ray enters the box of the reference in hand */
  float start = 0.0;     /* in world space, of the ray in object space */
  float scale = 1.0;
  float t_outside = t_max; /* hit.t when the instance was entered */
#endif
  bool pop = false; /* whether the next reference comes from the stack */
  while (true) {
    /* Down to the next leaf. Apart from the leaves' tests, which vector processors would carry along masked; left as soon as
     * there is a leaf or nothing any more, since they go on until the last lane does so. */
    while (true) {
      if (pop) {
#ifdef HAS_INSTANCES
        if (top == instance_top) {
          hit.t = hit.instance == instance ? start + hit.t / scale : t_outside;
          ray = world_ray;
          slabs = bvh_slabs(ray);
          instance = -1;
          instance_top = -1;
        }
#endif
        top--;
        reference = next;
        next = stack[top];
#ifdef HAS_INSTANCES
        enters = next_t;
        next_t = stack_t[top];
        if (enters >= floatBitsToInt(hit.t)) {
          if (top == 0) {
            break;
          }
          continue;
        }
#endif
        pop = false;
      }
      if (!REFERENCE_IS_INNER(reference)) {
        break;
      }
      Node node = read_node(reference);
      int t_0 = bvh_box_hit(node.lower_0, node.upper_0, slabs, floatBitsToInt(hit.t));
      int t_1 = bvh_box_hit(node.lower_1, node.upper_1, slabs, floatBitsToInt(hit.t));
      int child_0 = REFERENCE(node.first_0, node.leaf_0);
      int child_1 = REFERENCE(node.first_1, node.leaf_1);
      bool first_is_near = t_0 <= t_1;
      int t_near = min(t_0, t_1);
      int t_far = max(t_0, t_1);
      reference = first_is_near ? child_0 : child_1;
      stack[top] = next;
      next = t_far < BVH_MISS ? (first_is_near ? child_1 : child_0) : next;
#ifdef HAS_INSTANCES
      stack_t[top] = next_t;
      next_t = t_far < BVH_MISS ? t_far : next_t;
#endif
      top += t_far < BVH_MISS ? 1 : 0;
      pop = t_near == BVH_MISS;
#ifdef HAS_INSTANCES
      enters = t_near;
#endif
      if (pop ? top == 0 : !REFERENCE_IS_INNER(reference)) {
        break;
      }
    }
    if (pop) {
      break;
    }
    int leaf = LEAF_OF(reference);
#ifdef HAS_INSTANCES
    if (LEAF_KIND(leaf) == KIND_INSTANCE) {
      Instance entered = read_instance(REFERENCE_INDEX(reference));
      if (!ray_sees(world_ray, entered.visibility)) {
        pop = true;
        if (top == 0) {
          break;
        }
        continue;
      }
      instance = REFERENCE_INDEX(reference);
      instance_top = top;
      start = BVH_APPROACH * intBitsToFloat(enters);
      ray = bvh_object_ray(entered, read_instance_surface(instance), world_ray, start, scale);
      slabs = bvh_slabs(ray);
      t_outside = hit.t;
      hit.t = (hit.t - start) * scale;
      reference = REFERENCE(entered.root, entered.root_high);
      continue;
    }
#endif
    float t_before = hit.t;
#ifdef HAS_GRID
    if (LEAF_KIND(leaf) == KIND_GRID) {
      grid_hit(REFERENCE_INDEX(reference), ray, any_hit, hit);
    }
#endif
    primitive_leaf_hit(LEAF_KIND(leaf), REFERENCE_INDEX(reference), LEAF_COUNT(leaf), ray, hit);
    if (hit.t < t_before) {
#ifdef HAS_INSTANCES
      hit.instance = instance;
#endif
      if (any_hit) {
        break;
      }
    }
    pop = true;
    if (top == 0) {
      break;
    }
  }
#ifdef HAS_INSTANCES
  if (instance >= 0) { /* it ended inside an instance */
    hit.t = hit.instance == instance ? start + hit.t / scale : t_outside;
  }
#endif
  return hit;
#endif
}

#ifdef HAS_INSTANCES
/* Normals go with the transposed inverse; the length is that of 1 / stretch along the normal. */
vec3 bvh_world_normal(Instance instance, vec3 n)
{
  return n.x * instance.to_object_x.xyz + n.y * instance.to_object_y.xyz + n.z * instance.to_object_z.xyz;
}

/* The surface of a hit within an instance, from object space to world space. `seen`: as large as the numbers that the
 * position was made of, in world space. */
Surface bvh_placed_surface(Surface surface, Instance instance, InstanceSurface placed, vec3 seen)
{
  vec3 normal = surface.geometric_normal;
  vec4 position = vec4(surface.position, 1.0);
  surface.position =
      vec3(dot(placed.to_world_x, position), dot(placed.to_world_y, position), dot(placed.to_world_z, position));
  vec3 world_normal = bvh_world_normal(instance, normal);
  float stretch = 1.0 / length(world_normal); /* of a length along the normal */
  surface.geometric_normal = stretch * world_normal;
  surface.shading_normal = normalize(bvh_world_normal(instance, surface.shading_normal));
  /* The object's own error, the rounding of the ray on its way there, and of the position on its way back. */
  vec4 here = abs(position);
  vec4 there = vec4(seen, 1.0);
  vec3 inwards =
      vec3(dot(abs(instance.to_object_x), there), dot(abs(instance.to_object_y), there), dot(abs(instance.to_object_z), there));
  vec3 outwards = vec3(dot(abs(placed.to_world_x), here), dot(abs(placed.to_world_y), here), dot(abs(placed.to_world_z), here));
  surface.error = stretch * (surface.error + ray_flat_error(normal, inwards)) + ray_flat_error(surface.geometric_normal, outwards);
  surface.material += instance.first_material;
#ifdef HAS_TRIANGLE
  surface.lift = vec3(dot(placed.to_world_x.xyz, surface.lift), dot(placed.to_world_y.xyz, surface.lift),
                      dot(placed.to_world_z.xyz, surface.lift));
#endif
#ifdef HAS_GRADIENTS
  surface.gradient_u = bvh_world_normal(instance, surface.gradient_u);
  surface.gradient_v = bvh_world_normal(instance, surface.gradient_v);
#endif
#ifdef HAS_ATTRIBUTES
  surface.geometry = instance.geometry;
#ifdef HAS_GRADIENTS
  surface.gradient_first = bvh_world_normal(instance, surface.gradient_first);
  surface.gradient_second = bvh_world_normal(instance, surface.gradient_second);
#endif
#endif
  return surface;
}
#endif

/* The surface of a hit, in world space. */
Surface bvh_surface(Hit hit, Ray world_ray)
{
  vec3 seen = world_ray.origin + hit.t * world_ray.direction;
  Ray ray = world_ray;
#ifdef HAS_INSTANCES
  Instance instance;
  InstanceSurface placed;
  if (hit.instance >= 0) {
    float scale;
    instance = read_instance(hit.instance);
    placed = read_instance_surface(hit.instance);
    ray = bvh_object_ray(instance, placed, world_ray, hit.t, scale);
    hit.t = 0.0;
  }
#endif
  Surface surface = primitive_surface(hit, ray);
#ifdef HAS_ATTRIBUTES
  surface.kind = hit.kind;
  surface.index = hit.index;
  surface.instance = hit.instance;
#endif
#ifdef HAS_INSTANCES
  if (hit.instance >= 0) {
    surface = bvh_placed_surface(surface, instance, placed, abs(seen));
  }
#endif
  if (primitive_is_flat(hit.kind)) { /* along a floor that reaches far its coordinates are coarse: what was seen is finer */
    surface.position = seen + dot(surface.geometric_normal, surface.position - seen) * surface.geometric_normal;
  }
  return surface;
}

/* The visibility of what was hit, see `scene.Visibility`. */
int bvh_visibility(Hit hit)
{
#ifdef HAS_PLANE
  if (hit.kind == KIND_PLANE) {
    return read_plane(hit.index).visibility;
  }
#endif
#ifdef HAS_INSTANCES
  if (hit.instance >= 0) {
    return read_instance(hit.instance).visibility;
  }
#endif
  return VISIBILITY_ALL;
}
