/* What the light that reaches a surface adds to the pixel. */
#include "bvh_lib.glsl"
#include "material_lib.glsl"
#include "medium_lib.glsl"
#include "optics_lib.glsl"
#ifdef HAS_ROUGHNESS
#include "gloss_lib.glsl"
#endif

/* A surface being lit. */
struct Lit {
  Surface surface;
  vec3 normal; /* shading normal on the side of the path ray */
  vec3 view;   /* direction of the path ray */
  vec3 diffuse;
  vec3 highlight;
  float shine;
  ivec4 media; /* around the lit side */
  int shadow;  /* kind of the shadow rays */
#ifdef HAS_LIGHT_SHAPES
  int depth; /* of the path ray */
#endif
#ifdef HAS_ROUGHNESS
  Material material; /* with shares of the pixel */
  float eta;         /* index on the lit side over the one beyond */
  ivec4 beyond;      /* media around the other side */
#endif
};

/* Whether light that comes from the other side of a lit surface is to be seen. */
bool lit_through(Lit lit)
{
#ifdef HAS_ROUGHNESS
  return gloss_transmission_is_rough(lit.material, lit.eta);
#else
  return false;
#endif
}

/* Whether lights add anything. */
bool lit_is(Lit lit)
{
#ifdef HAS_ROUGHNESS
  if (gloss_mirror_is_rough(lit.material) || lit_through(lit)) {
    return true;
  }
#endif
  return optics_largest(lit.diffuse) > 0.0 || optics_largest(lit.highlight) > 0.0;
}

/* What the light that reaches a lit surface from `direction` adds to the pixel; `cosine` is its to the surface's normal. */
vec3 lit_by(Lit lit, vec3 radiance, vec3 direction, float cosine)
{
  vec3 share = lit.diffuse * max(cosine, 0.0);
#ifdef HAS_ROUGHNESS
  share += gloss_lit(lit.material, lit.eta, lit.normal, -lit.view, direction);
  if (cosine <= 0.0) {
    return radiance * share;
  }
#endif
  float alignment = max(dot(optics_mirror(lit.view, lit.normal), direction), 0.0);
  if (optics_largest(lit.highlight) > 0.0 && alignment > 0.0) {
    share += lit.highlight * pow(alignment, lit.shine);
  }
  return radiance * share;
}
