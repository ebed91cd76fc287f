/* Mirror, refraction and absorption: paper 3.3 and 2.3, with what the text breaks off before. */

float optics_largest(vec3 color)
{
  return max(color.r, max(color.g, color.b));
}

float optics_mean(vec3 color)
{
  return (color.r + color.g + color.b) / 3.0;
}

/* Exact reflectance of unpolarised light at a smooth dielectric. `cos_i` >= 0, `eta` = n_from / n_to; `cos_t` is the
 * refracted ray's, and the reflectance is 1 at total internal reflection. (Born and Wolf 1.5.2.) */
float optics_fresnel(float cos_i, float eta, out float cos_t)
{
  float k = (1.0 - eta) * (1.0 + eta) + eta * eta * cos_i * cos_i; /* 1 - (eta sin_i)^2 without its cancellation */
  cos_t = sqrt(max(k, 0.0));
  if (k <= 0.0) {
    return 1.0;
  }
  float r_s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  float r_p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 0.5 * (r_s * r_s + r_p * r_p);
}

/* Its mean over the directions that a diffuse surface is lit from: fits for a denser body beyond and before (Kulla and Conty 2017,
 * Revisiting Physically Based Shading at Imageworks). */
float optics_fresnel_mean(float eta)
{
  float n = 1.0 / eta;
  return n < 1.0 ? 0.997118 + n * (0.1014 - n * (0.965241 + n * 0.130607)) : (n - 1.0) / (4.08567 + 1.00071 * n);
}

/* Reflectance of a metal that has the share `normal` at normal incidence and `grazing`, if that is more, at grazing incidence
 * (Schlick 1994); near 82 degrees, where the cosine is 1/7, it is `edge` of that (Hoffman 2023). */
vec3 optics_metal(vec3 normal, vec3 grazing, vec3 edge, float cosine)
{
  vec3 rise = max(grazing - normal, 0.0);
  float s = clamp(1.0 - cosine, 0.0, 1.0);
  float s5 = s * s * s * s * s;
  vec3 at_edge = normal + rise * 0.46266436; /* (6/7)^5 */
  return max(normal + rise * s5 - at_edge * (1.0 - edge) * (17.651385 * cosine * s5 * s), 0.0); /* 7 (7/6)^6 */
}

/* Its mean over the directions that a diffuse surface is lit from. */
vec3 optics_metal_mean(vec3 normal, vec3 grazing, vec3 edge)
{
  vec3 rise = max(grazing - normal, 0.0);
  return normal + rise / 21.0 - (normal + rise * 0.46266436) * (1.0 - edge) * (17.651385 / 126.0);
}

/* Reflectance of unpolarised light at a smooth metal of the complex index of refraction `index` + i `extinction`. (Born and Wolf
 * 14.2.) */
vec3 optics_conductor(float cosine, vec3 index, vec3 extinction)
{
  float sine_square = 1.0 - cosine * cosine;
  vec3 difference = index * index - extinction * extinction - sine_square;
  vec3 product = index * extinction;
  vec3 squares = sqrt(difference * difference + 4.0 * product * product); /* a^2 + b^2 of the root a + i b */
  vec3 a = sqrt(max(0.5 * (squares + difference), 0.0));
  vec3 across = (squares + cosine * cosine - 2.0 * cosine * a) / (squares + cosine * cosine + 2.0 * cosine * a);
  vec3 sums = cosine * cosine * squares + sine_square * sine_square;
  vec3 along = across * (sums - 2.0 * cosine * sine_square * a) / (sums + 2.0 * cosine * sine_square * a);
  return 0.5 * (across + along);
}

/* (48). */
vec3 optics_mirror(vec3 direction, vec3 normal)
{
  return normalize(direction - 2.0 * dot(normal, direction) * normal);
}

/* Snell's law; `normal` faces the incoming ray. */
vec3 optics_refract(vec3 direction, vec3 normal, float cos_i, float cos_t, float eta)
{
  return normalize(eta * direction + (eta * cos_i - cos_t) * normal);
}

/* Beer and Lambert. A length that is not finite belongs to a ray that ends nowhere. */
vec3 optics_absorb(vec3 absorption, float path_length)
{
  return exp(-absorption * path_length);
}
