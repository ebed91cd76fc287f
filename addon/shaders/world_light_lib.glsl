/* The world as a light on surfaces: directions towards it by chance, its light without shadows, ambient occlusion. */
#include "octahedron_lib.glsl"
#include "sampling_lib.glsl"

#ifdef HAS_WORLD_LIGHT
#include <world_light_cell>

/* The map of the world's brightness is a square of 2^levels cells a side, and a tree over it: an entry holds the brightness
 * of its four quarters, 1 the mean of all directions. The entries of a level lie row by row after those of the coarser. */
int world_light_level(int level)
{
  return ((1 << (2 * level)) - 1) / 3;
}

/* A direction by brightness, chosen by `u`: down the tree, along x and then along y (Clarberg et al. 2005, Wavelet Importance
 * Sampling). What is left of `u` places it in the cell, so that even `u` are even in the cells. */
vec3 world_light_bright_direction(vec2 u)
{
  int levels = int(frame_world_light_levels);
  ivec2 cell = ivec2(0);
  for (int level = 0; level < levels; level++) {
    vec4 quarters = read_world_light_cell(world_light_level(level) + (cell.y << level) + cell.x).quarters;
    vec2 left = quarters.xz;
    vec2 right = quarters.yw;
    float total = left.x + left.y + right.x + right.y;
    float share = (left.x + left.y) / max(total, 1e-30);
    bool goes_right = u.x >= share;
    u.x = goes_right ? (u.x - share) / max(1.0 - share, 1e-30) : u.x / share;
    vec2 column = goes_right ? right : left;
    share = column.x / max(column.x + column.y, 1e-30);
    bool goes_up = u.y >= share;
    u.y = goes_up ? (u.y - share) / max(1.0 - share, 1e-30) : u.y / share;
    u = min(u, vec2(0.9999999));
    cell = 2 * cell + ivec2(goes_right ? 1 : 0, goes_up ? 1 : 0);
  }
  return octahedron_direction((vec2(cell) + u) / float(1 << levels));
}

/* The brightness that the map has in a direction; over 4 pi the density of the directions above. */
float world_light_brightness(vec3 direction)
{
  int level = int(frame_world_light_levels) - 1;
  ivec2 cell = min(ivec2(octahedron_uv(direction) * float(2 << level)), ivec2((2 << level) - 1));
  ivec2 entry = cell / 2;
  vec4 quarters = read_world_light_cell(world_light_level(level) + (entry.y << level) + entry.x).quarters;
  vec2 row = cell.y > 2 * entry.y ? quarters.zw : quarters.xy;
  return cell.x > 2 * entry.x ? row.y : row.x;
}

/* Density of the directions that are chosen by brightness, times 2 pi as all here. */
float world_light_density(vec3 direction)
{
  float share = 1.0 - frame_world_cosine_share;
  return share > 0.0 ? 0.5 * share * world_light_brightness(direction) : 0.0;
}

/* A direction for light on a surface with this normal, of which `behind` of the light that counts comes from the other side;
 * `scale` times the world's radiance there is, in the mean over `u`, the radiance that a white diffuse surface returns, cosine
 * apart. Some are chosen by the cosine, the others by brightness; the density is that of both together (Veach and Guibas
 * 1995, the balance heuristic). */
vec3 world_light_direction(vec3 normal, float behind, vec2 u, out float scale)
{
  float share = frame_world_cosine_share;
  vec3 direction;
  if (u.x < share) {
    u.x /= share;
    bool turned = u.x < behind;
    u.x = turned ? u.x / behind : (u.x - behind) / (1.0 - behind);
    vec2 disc = sampling_disc(u);
    vec3 around = sampling_around(normal, vec3(disc, sqrt(max(1.0 - dot(disc, disc), 0.0))));
    direction = turned ? around - 2.0 * dot(around, normal) * normal : around;
  }
  else {
    u.x = min((u.x - share) / (1.0 - share), 0.9999999);
    direction = world_light_bright_direction(u);
  }
  float cosine = dot(direction, normal);
  float density = share * 2.0 * abs(cosine) * (cosine < 0.0 ? behind : 1.0 - behind);
  density += world_light_density(direction);
  scale = 2.0 / max(density, 1e-30);
  return direction;
}
#endif

#ifdef HAS_HEMISPHERE_LIGHT
/* What a white diffuse surface with this normal returns of the world where nothing is in the way: spherical harmonics up to
 * order 2 as a polynomial of the normal (Ramamoorthi and Hanrahan 2001, An Efficient Representation for Irradiance
 * Environment Maps), within 3% for natural skies. */
vec3 world_light_hemisphere(vec3 normal)
{
  vec3 square = normal * normal;
  vec3 mixed = normal * normal.yzx;
  vec3 light = frame_world_xx * square.x + frame_world_yy * square.y + frame_world_zz * square.z;
  light += frame_world_xy * mixed.x + frame_world_yz * mixed.y + frame_world_zx * mixed.z;
  light += frame_world_x * normal.x + frame_world_y * normal.y + frame_world_z * normal.z;
  return max(light, vec3(0.0));
}
#endif

#ifdef HAS_AMBIENT_OCCLUSION
/* Direction number `ray` of those that ask what is near a surface, as dense as the cosine: the same at every surface where
 * a pixel has one sample, so that there is no noise, otherwise by `u`. */
vec3 world_light_ambient_direction(vec3 normal, int ray, vec2 u)
{
  if (frame_sample < 0.0) { /* a sunflower's seeds */
    u = vec2((float(ray) + 0.5) / frame_ao_rays, float(ray) * 0.38196601);
  }
  vec2 disc = sampling_disc(u);
  return sampling_around(normal, vec3(disc, sqrt(max(1.0 - dot(disc, disc), 0.0))));
}
#endif
