/* What the light that reaches a surface adds to the pixel. */
#include "bvh_lib.glsl"
#include "material_lib.glsl"
#include "medium_lib.glsl"
#include "optics_lib.glsl"
#ifdef HAS_ROUGHNESS
#include "gloss_lib.glsl"
#endif
#ifdef HAS_COAT /* which is drawn by what draws rough mirrors: `HAS_ROUGHNESS` holds too */
#include "gloss_lib.glsl"
#endif
#ifdef HAS_DIFFUSE_ROUGHNESS
#include "diffuse_lib.glsl"
#endif

/* A surface being lit. */
struct Lit {
  Surface surface;
  vec3 normal; /* shading normal on the side of the path ray, of what is diffuse */
  vec3 view;   /* direction of the path ray */
  vec3 diffuse;
  vec3 highlight;
  float shine;
  ivec4 media; /* around the lit side */
  int shadow;  /* kind of the shadow rays */
  int depth;   /* of the path ray */
#ifdef HAS_LIGHT_PATH
  int passed; /* by the path ray, see `Path` */
#endif
#ifdef HAS_LIGHT_TREE
  float light_total; /* see `light_tree_total` */
#endif
#ifdef HAS_LIGHT_LINKING
  int visibility; /* whose groups say which lights light it */
#endif
#ifdef HAS_ROUGHNESS
  Material material; /* with shares of the pixel */
  float eta;         /* index on the lit side over the one beyond */
  ivec4 beyond;      /* media around the other side */
  float of_coat;     /* part of the mirrors' rays that the coat takes */
#endif
#ifdef HAS_TRANSLUCENT
  vec3 translucent;
#endif
#ifdef HAS_DIFFUSE_ROUGHNESS
  float diffuse_roughness;
  vec3 given_back; /* see `diffuse_given_back` */
#endif
#ifdef HAS_NORMALS
  vec3 smooth_normal; /* what `normal` replaces, which is the same where a material has none */
  vec3 mirror_normal; /* the same of mirrors: they look at the path ray and mirror it off the surface */
#endif
};

vec3 lit_mirror_normal(Lit lit)
{
#ifdef HAS_NORMALS
  return lit.mirror_normal;
#else
  return lit.normal;
#endif
}

/* Whether light that comes from the other side of a lit surface is to be seen. */
bool lit_through(Lit lit)
{
  bool through = false;
#ifdef HAS_ROUGHNESS
  through = gloss_transmission_is_rough(lit.material, lit.eta);
#endif
#ifdef HAS_TRANSLUCENT
  through = through || optics_largest(lit.translucent) > 0.0;
#endif
  return through;
}

/* Whether light from `direction`, of a cosine to the normal of what is diffuse, comes from the side of the path ray. */
bool lit_before(Lit lit, vec3 direction, float cosine)
{
  return cosine > 0.0 || dot(lit_mirror_normal(lit), direction) > 0.0;
}

/* Whether lights add anything. */
bool lit_is(Lit lit)
{
  bool lit_by_facets = false;
#ifdef HAS_ROUGHNESS
  lit_by_facets = gloss_mirror_is_rough(lit.material) || gloss_coat_is_rough(lit.material);
#endif
  return lit_by_facets || optics_largest(max(lit.diffuse, lit.highlight)) > 0.0 || lit_through(lit);
}

#ifdef HAS_NORMALS
/* Share of the light on a bumpy surface that its bumps do not keep off one another, so that no light leaks to what the smooth
 * surface has in the shade, nor ends there all at once (Estevez, Lecocq and Stein 2019, A Microfacet-Based Shadowing Function to
 * Solve the Bump Terminator Problem; its smooth step as in Cycles). */
float lit_between_bumps(Lit lit, vec3 direction)
{
  float aligned = dot(lit.smooth_normal, lit.normal);
  float share = dot(lit.smooth_normal, direction) / max(dot(lit.normal, direction) * aligned, 1e-6);
  share = clamp(share, 0.0, 1.0);
  return aligned > 0.99999 ? 1.0 : share + share * share * (1.0 - share);
}
#endif

/* The share of the pixel that diffuse bodies have of light from `direction`; `cosine` is its to the surface's normal. */
vec3 lit_diffuse(Lit lit, vec3 direction, float cosine)
{
  vec3 share = lit.diffuse * max(cosine, 0.0);
#ifdef HAS_DIFFUSE_ROUGHNESS
  share *= diffuse_rough(lit.diffuse_roughness, lit.given_back, -dot(lit.normal, lit.view), cosine, -dot(lit.view, direction));
#endif
#ifdef HAS_NORMALS
  share *= lit_between_bumps(lit, direction);
#endif
#ifdef HAS_TRANSLUCENT
  share += lit.translucent * max(-cosine, 0.0);
#endif
  return share;
}

/* How much of the diffuse light that counts comes from the other side, 0 to 1. */
float lit_behind(Lit lit)
{
#ifdef HAS_TRANSLUCENT
  float behind = optics_mean(lit.translucent);
  return behind / max(behind + optics_mean(lit.diffuse), 1e-30);
#else
  return 0.0;
#endif
}

#ifdef HAS_ROUGHNESS
/* The same of rough mirrors and rough glass; see `gloss_lit` for `asked`. */
vec3 lit_glossy(Lit lit, vec3 direction, float asked)
{
  return gloss_lit(lit.material, lit.eta, lit_mirror_normal(lit), -lit.view, direction, lit.of_coat, asked);
}
#endif

/* The same of all but those. */
vec3 lit_plain(Lit lit, vec3 direction, float cosine)
{
  vec3 share = lit_diffuse(lit, direction, cosine);
  float alignment = max(dot(optics_mirror(lit.view, lit_mirror_normal(lit)), direction), 0.0);
  if (optics_largest(lit.highlight) > 0.0 && alignment > 0.0 && cosine > 0.0) {
    share += lit.highlight * pow(alignment, lit.shine);
  }
  return share;
}
