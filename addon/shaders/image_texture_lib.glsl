/* Images lie one after the other in one data texture, so that any number of them takes one sampler. Pixels of four floats
   take a texel each, those of bytes share one: see `image_packing`. */
#include <image>

#define IMAGE_LINEAR 1
#define IMAGE_CUBIC 2

#define IMAGE_REPEAT 0
#define IMAGE_EXTEND 1
#define IMAGE_CLIP 2
#define IMAGE_MIRROR 3

#define IMAGE_SRGB 1
#define IMAGE_DIVIDED 2

/* What is drawn in place of an image that is missing. */
#define IMAGE_MISSING vec4(1.0, 0.0, 1.0, 1.0)

/* The pixel of a number, row after row. */
vec4 image_pixel(Image image, int number)
{
  vec4 texel = fetch_images(JOIN_INDEX(image.first, image.first_high) + (number >> image.packing));
  if (image.packing == 0) {
    return texel;
  }
  vec2 lower = (number & 1) == 0 ? texel.xy : texel.zw;
  if (image.packing == 2) {
    lower = (number & 2) == 0 ? texel.xy : texel.zw;
    lower = vec2((number & 1) == 0 ? lower.x : lower.y, 255.0);
  }
  int color = int(lower.x);
  return vec4(float(color & 255), float((color >> 8) & 255), float(color >> 16), lower.y) / 255.0;
}

/* Row or column of a picture of `size`, for one that may lie outside of it. */
int image_wrapped(int extension, int place, int size)
{
  if (extension == IMAGE_REPEAT || extension == IMAGE_MIRROR) {
    int period = extension == IMAGE_MIRROR ? 2 * size : size;
    place -= period * int(floor(float(place) / float(period)));
    place = place < size ? place : period - 1 - place;
  }
  return clamp(place, 0, size - 1);
}

/* Weight of a pixel at a distance, along one axis: a box, a tent or the cubic B-spline. */
float image_weight(int interpolation, float dist)
{
  float inner = max(1.0 - dist, 0.0);
  float outer = max(2.0 - dist, 0.0);
  float cubic = (outer * outer * outer - 4.0 * inner * inner * inner) / 6.0;
  return interpolation == IMAGE_CUBIC ? cubic : (interpolation == IMAGE_LINEAR ? inner : 1.0);
}

/* Linear values of sRGB. */
vec3 image_decoded(vec3 color)
{
  vec3 curve = pow(max((color + 0.055) / 1.055, vec3(1e-9)), vec3(2.4));
  return mix(curve, color / 12.92, lessThan(color, vec3(0.04045)));
}

/* Color of an image at uv, (0, 0) its lower left corner: multiplied by alpha unless the image says otherwise. As in Cycles
   what lies between pixels of sRGB is mixed before it is decoded. */
vec4 image_sample(int index, vec2 uv)
{
  Image image = read_image(index);
  /* Before it is multiplied: far from the origin the fraction would drown. */
  if (image.extension == IMAGE_REPEAT) {
    uv -= floor(uv);
  }
  else if (image.extension == IMAGE_MIRROR) {
    uv -= 2.0 * floor(0.5 * uv);
  }
  vec2 position = clamp(uv, vec2(-1e3), vec2(1e3)) * vec2(float(image.width), float(image.height));
  /* One, four or sixteen pixels: 2 to the power of `interpolation` along each axis. */
  int taps = 1 << image.interpolation;
  position -= image.interpolation == 0 ? 0.0 : 0.5;
  ivec2 corner = ivec2(floor(position)) - (taps >> 2);
  vec4 color = vec4(0.0);
  for (int tap = 0; tap < taps * taps; tap++) {
    ivec2 place = corner + ivec2(tap & (taps - 1), tap >> image.interpolation);
    vec2 dist = abs(position - vec2(place));
    float weight = image_weight(image.interpolation, dist.x) * image_weight(image.interpolation, dist.y);
    int x = image_wrapped(image.extension, place.x, image.width);
    int y = image_wrapped(image.extension, place.y, image.height);
    bool seen = image.extension != IMAGE_CLIP || (x == place.x && y == place.y);
    color += (seen ? weight : 0.0) * image_pixel(image, y * image.width + x);
  }
  if ((image.coding & IMAGE_DIVIDED) != 0 && color.a != 0.0) {
    color.rgb /= color.a;
  }
  return (image.coding & IMAGE_SRGB) != 0 ? vec4(image_decoded(color.rgb), color.a) : color;
}

/* The same of `count` images from number `first` on, the tiles of a UDIM image: ten in each row of unit squares. */
vec4 image_sample_tiled(int first, int count, vec2 uv)
{
  ivec2 tile = ivec2(uv); /* as Cycles: what is less than 0 but more than -1 belongs to tile 0 */
  int number = 10 * tile.y + tile.x;
  bool known = tile.x >= 0 && tile.x < 10 && tile.y >= 0 && number < count;
  vec4 color = image_sample(first + (known ? number : 0), uv - vec2(tile));
  return known ? color : IMAGE_MISSING;
}
