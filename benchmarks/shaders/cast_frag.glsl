/* Eye rays, and from what they hit a shadow ray to each light in front of it: the traversal without any shading.
 * To the pixel are added hits, shadow rays and those that arrive. */
#include "camera_lib.glsl"
#include "bvh_lib.glsl"
#include "cast_lights_lib.glsl"

void main()
{
  float t_max;
  Ray eye = camera_ray(PIXEL, t_max);
  Hit hit = bvh_traverse(eye, t_max, false);
  Surface surface = bvh_surface(hit, eye);
  float facing = dot(surface.geometric_normal, eye.direction);
  float shadows = 0.0, arrived = 0.0;
  for (int light = 0; light < CAST_LIGHTS; light++) {
    vec3 way = cast_light(light) - surface.position;
    if (hit.kind >= 0 && facing * dot(surface.geometric_normal, way) < 0.0) {
      vec3 direction = normalize(way);
      Ray ray = ray_make(ray_spawn(surface, direction), direction, RAY_SHADOW);
      Hit occluder = bvh_traverse(ray, length(way), true);
      shadows += 1.0;
      arrived += occluder.kind < 0 ? 1.0 : 0.0;
    }
  }
  out_color = vec4(hit.kind >= 0 ? 1.0 : 0.0, shadows, arrived, 0.0);
}
