// The picture so far, a texel for each square of `pixel_size` pixels: scene-linear, premultiplied, as it is.
void main()
{
  out_color = texelFetch(picture, ivec2(gl_FragCoord.xy) / pixel_size, 0);
}
