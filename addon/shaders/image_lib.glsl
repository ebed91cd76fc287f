/* Images lie texel after texel in one data texture, so that any number of them takes one sampler. */
#include <image>

#define IMAGE_REPEAT 0
#define IMAGE_EXTEND 1
#define IMAGE_CLIP 2

vec4 image_texel(Image image, int x, int y)
{
  if (image.extension == IMAGE_REPEAT) {
    x = x - image.width * int(floor(float(x) / float(image.width)));
    y = y - image.height * int(floor(float(y) / float(image.height)));
  }
  else if (image.extension == IMAGE_CLIP && (x < 0 || y < 0 || x >= image.width || y >= image.height)) {
    return vec4(0.0);
  }
  x = clamp(x, 0, image.width - 1);
  y = clamp(y, 0, image.height - 1);
  return fetch_images(JOIN_INDEX(image.first, image.first_high) + y * image.width + x);
}

/* Premultiplied colour at uv; (0, 0) is the lower left corner of the picture. */
vec4 image_sample(int index, vec2 uv)
{
  Image image = read_image(index);
  if (image.extension == IMAGE_REPEAT) {
    uv -= floor(uv); /* before it is multiplied: far from the origin the fraction would drown */
  }
  vec2 position = clamp(uv, vec2(-1e3), vec2(1e3)) * vec2(float(image.width), float(image.height));
  if (image.interpolation == 0) {
    return image_texel(image, int(floor(position.x)), int(floor(position.y)));
  }
  vec2 corner = floor(position - 0.5);
  vec2 weight = position - 0.5 - corner;
  int x = int(corner.x);
  int y = int(corner.y);
  vec4 lower = mix(image_texel(image, x, y), image_texel(image, x + 1, y), weight.x);
  vec4 upper = mix(image_texel(image, x, y + 1), image_texel(image, x + 1, y + 1), weight.x);
  return mix(lower, upper, weight.y);
}
