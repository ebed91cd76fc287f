// The picture so far, scene-linear and premultiplied, as it is.
void main()
{
  ivec2 size = textureSize(picture, 0);
  out_color = texelFetch(picture, clamp(ivec2(uv * vec2(size)), ivec2(0), size - 1), 0);
}
