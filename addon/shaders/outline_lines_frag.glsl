/* The lines of one sample of the picture, as wide as they are drawn: premultiplied colour and coverage. */

void main()
{
  ivec2 size = textureSize(marks_data, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float covered = 0.0;
  vec2 widths = vec2(frame_outline_width, frame_outline_inner_width);
  int reach = int(ceil(max(0.5 * max(widths.x, widths.y) - 0.5, 0.0)));
  for (int y = -reach; y <= reach; y++) {
    for (int x = -reach; x <= reach; x++) {
      vec4 mark = texelFetch(marks_data, clamp(pixel + ivec2(x, y), ivec2(0), size - 1), 0);
      float far = length(vec2(x, y)) - 0.5;
      /* A line narrower than a pixel is lighter instead. */
      vec2 shares = mark.xy * min(clamp(0.5 * widths - far, 0.0, 1.0), widths);
      covered = max(covered, max(shares.x, shares.y));
    }
  }
  float alpha = covered * frame_outline_color.a;
  out_line = vec4(alpha * frame_outline_color.rgb, alpha);
}
