/* A little of what the path tracer does, to find out which entry suits a GPU: rays among spheres, fetches that depend on
 * the one before, neighbours that part from each other. Node n of the tree is a sphere (centre, radius) around nodes 2 n
 * and 2 n + 1; from PROBE_LEAVES on they are what is to be hit. The texture has that many nodes in a row. */

#define PROBE_BOUNCES 4

vec4 probe_sphere(int node)
{
  return texel_probe(ivec2(node % PROBE_LEAVES, node / PROBE_LEAVES));
}

/* Distance along a ray to where it enters a sphere, `far` where it does not before that. */
float probe_hit(vec4 sphere, vec3 origin, vec3 direction, float far)
{
  vec3 to_center = sphere.xyz - origin;
  float middle = dot(to_center, direction);
  float half_square = sphere.w * sphere.w - dot(to_center, to_center) + middle * middle;
  if (half_square < 0.0) {
    return far;
  }
  float t = middle - sqrt(half_square);
  return t > 1e-4 ? min(t, far) : far;
}

/* Whether a ray meets a sphere before the distance `far`, from within too. */
bool probe_meets(vec4 sphere, vec3 origin, vec3 direction, float far)
{
  vec3 to_center = sphere.xyz - origin;
  float middle = dot(to_center, direction);
  float half_square = sphere.w * sphere.w - dot(to_center, to_center) + middle * middle;
  return half_square >= 0.0 && middle + sqrt(half_square) > 0.0 && middle - sqrt(half_square) < far;
}

vec4 probe_sample()
{
  vec3 origin = vec3(PIXEL / 32.0, -4.0);
  vec3 direction = normalize(vec3(0.1, 0.07, 1.0));
  vec4 path = vec4(0.0);
  for (int bounce = 0; bounce < PROBE_BOUNCES; bounce++) {
    float t = 1e30;
    vec4 found = vec4(0.0);
    int node = 1;
    while (node > 0) {
      vec4 sphere = probe_sphere(node);
      bool is_leaf = node >= PROBE_LEAVES;
      if (!is_leaf && probe_meets(sphere, origin, direction, t)) {
        node *= 2;
      }
      else {
        if (is_leaf) {
          float nearer = probe_hit(sphere, origin, direction, t);
          found = nearer < t ? sphere : found;
          t = nearer;
        }
        while ((node & 1) == 1) { /* the second of two: up to where there is one beside it */
          node /= 2;
        }
        node += node > 0 ? 1 : 0;
      }
    }
    if (found.w == 0.0) {
      break;
    }
    origin += t * direction;
    vec3 normal = (origin - found.xyz) / found.w;
    direction = normalize(reflect(direction, normal));
    path += vec4(normal, 1.0);
  }
  return path;
}
