/* Rays and the numbers that keep them off the surface they start from. */

/* What a ray is, as the bits of `scene.Visibility` that an object must have for the ray to see it. Rays that pass straight
 * through a surface stay what they are. */
#define RAY_CAMERA 1
#define RAY_DIFFUSE 2 /* what sees the sky for a diffuse surface; on its way it is a shadow ray */
#define RAY_GLOSSY 4
#define RAY_TRANSMISSION 8
#define RAY_SHADOW 16
#define RAY_SHADOW_OF_CATCHERS 80 /* a shadow ray that only shadow catchers stop */

/* Further bits of it; those beyond are groups of objects that lights are linked to. */
#define VISIBILITY_DIFFUSE 2
#define VISIBILITY_GLOSSY 4
#define VISIBILITY_TRANSMISSION 8
#define VISIBILITY_ALL 31
#define VISIBILITY_HOLDOUT 32
#define VISIBILITY_SHADOW_CATCHER 64

struct Ray {
  vec3 origin;
  vec3 direction; /* unit */
  int kind;
};

/* What a hit needs to be shaded: everything in the space of the ray. */
struct Surface {
  vec3 position;
  vec3 geometric_normal; /* unit, outward: from the inside of the body to the outside */
  vec3 shading_normal;   /* unit, on the side of the geometric normal */
  vec2 uv;
  int material;
  float error; /* bound of the rounding error of position across the surface, an absolute length */
#ifdef HAS_TRIANGLE
  vec3 lift; /* from position to the smooth surface that the vertex normals tell, on the side that the ray comes from */
#endif
#ifdef HAS_GRADIENTS
  vec3 gradient_u; /* of uv over position, along the surface: what lies across it is of no meaning */
  vec3 gradient_v;
#endif
#ifdef HAS_ATTRIBUTES
  vec2 weights; /* of the second and the third value of the primitive's attributes */
#ifdef HAS_GRADIENTS
  vec3 gradient_first, gradient_second; /* of the weights */
#endif
  int kind;
  int index; /* of the primitive among those of its kind */
  int geometry;
  int instance; /* -1: in world space */
#endif
};

/* Structs are made by functions: Metal's language knows no constructors of the kind `Ray(origin, direction, kind)`. */
Ray ray_make(vec3 origin, vec3 direction, int kind)
{
  Ray ray;
  ray.origin = origin;
  ray.direction = direction;
  ray.kind = kind;
  return ray;
}

/* 1 over a direction. A tiny component in place of 0 gives a slab an interval without 0 * infinity. */
float ray_inverse_of(float x)
{
  return 1.0 / (abs(x) < 1e-30 ? (x < 0.0 ? -1e-30 : 1e-30) : x);
}

vec3 ray_inverse(vec3 direction)
{
  return vec3(ray_inverse_of(direction.x), ray_inverse_of(direction.y), ray_inverse_of(direction.z));
}

Surface ray_make_surface(vec3 position, vec3 geometric_normal, vec3 shading_normal, vec2 uv, int material, float error)
{
  Surface surface;
  surface.position = position;
  surface.geometric_normal = geometric_normal;
  surface.shading_normal = shading_normal;
  surface.uv = uv;
  surface.material = material;
  surface.error = error;
#ifdef HAS_TRIANGLE
  surface.lift = vec3(0.0);
#endif
#ifdef HAS_GRADIENTS
  surface.gradient_u = vec3(0.0);
  surface.gradient_v = vec3(0.0);
#endif
#ifdef HAS_ATTRIBUTES
#ifdef HAS_GRADIENTS
  surface.gradient_first = vec3(0.0);
  surface.gradient_second = vec3(0.0);
#endif
  surface.weights = vec2(0.0);
  surface.kind = -1;
  surface.index = 0;
  surface.geometry = 0;
  surface.instance = -1;
#endif
  return surface;
}

/* A position that is put on its surface again is wrong by a few roundings of the numbers that it was made of; 2^-18 is 32
 * units in the last place, which covers the intersection that the next ray makes of it as well. */
#define RAY_RELATIVE_ERROR 3.8e-6

float ray_error(vec3 position, float extent)
{
  vec3 size = abs(position);
  return RAY_RELATIVE_ERROR * (max(size.x, max(size.y, size.z)) + extent);
}

/* The same across a plane: what its normal sees of coordinates of this size. A floor is as exact as its height, however far
 * it reaches. */
float ray_flat_error(vec3 normal, vec3 size)
{
  return RAY_RELATIVE_ERROR * dot(abs(normal), abs(size));
}

/* Whether an object of this visibility is there for a ray. */
bool ray_sees(Ray ray, int visibility)
{
#ifdef HAS_VISIBILITY
  return (visibility & ray.kind) == ray.kind;
#else
#ifdef HAS_SHADOW_CATCHER
  return (visibility & ray.kind) == ray.kind;
#else
  return true;
#endif
#endif
}

/* Origin of a ray that leaves a surface towards `direction`: moved off along the normal, by no more than rounding asks for
 * (Waechter and Binder, Ray Tracing Gems, chapter 6, with a bound in place of their fixed steps). */
vec3 ray_spawn(Surface surface, vec3 direction)
{
  float side = dot(direction, surface.geometric_normal) < 0.0 ? -1.0 : 1.0;
  return surface.position + (side * surface.error) * surface.geometric_normal;
}
