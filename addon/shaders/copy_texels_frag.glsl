/* Texels of one data texture into another, as they follow each other row by row; those outside of the range stay. */

void main()
{
  ivec2 place = ivec2(gl_FragCoord.xy);
  int number = place.y * into_width + place.x - into_first;
  if (number < 0 || number >= count) {
    discard;
  }
  int width = textureSize(texels_data, 0).x;
  out_texel = texelFetch(texels_data, ivec2(number % width, number / width), 0);
}
