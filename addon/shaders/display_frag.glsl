// A picture while it forms: sums of samples over how many there are, scene-linear and premultiplied.

/* Samples of a texel: the first reached.y rows, and texels left of reached.w in the reached.z rows above, have one more than
   reached.x. */
float samples_of(ivec2 texel)
{
  ivec4 r = ivec4(reached);
  bool further = texel.y < r.y || (texel.y < r.y + r.z && texel.x < r.w);
  return reached.x + (further ? 1.0 : 0.0);
}

/* The mean of a texel's samples. The driver gave those up whose alpha is beyond any sum. */
vec4 mean_of(ivec2 texel)
{
  vec4 sum = texelFetch(color_sums, texel, 0);
  vec4 mean = sum / max(samples_of(texel), 1.0);
  return vec4(mean.rgb, sum.a >= UNENDED_ALPHA ? 1.0 : mean.a);
}

/* Lines over what is below, both premultiplied. A pixel that is half black looks half as bright as white though it gives off
   less than half the light: otherwise dark lines would look like strings of beads. */
vec4 with_lines(ivec2 texel, vec4 below)
{
  vec4 line = texelFetch(line_sums, texel, 0) / max(lines, 1.0);
  float brightness = (line.r + line.g + line.b) / max(3.0 * line.a, 1e-6);
  float exponent = mix(DISPLAY_GAMMA, 1.0, clamp(brightness, 0.0, 1.0));
  float alpha = 1.0 - pow(1.0 - clamp(line.a, 0.0, 1.0), exponent);
  return line * (alpha / max(line.a, 1e-6)) + (1.0 - alpha) * below;
}

vec4 shown(ivec2 texel)
{
  vec4 color = mean_of(texel);
  return lines > 0.0 ? with_lines(texel, color) : color;
}

/* A texel, or another one where no sample has reached it yet. */
vec4 shown_or(ivec2 texel, ivec2 other)
{
  return shown(samples_of(texel) < 0.5 ? other : texel);
}

/* Between the middles of four texels, of which `here` is the one that the position is in. */
vec4 shown_between(vec2 position, ivec2 here, ivec2 last)
{
  vec2 corner = floor(position - 0.5);
  vec2 share = position - 0.5 - corner;
  ivec2 low = clamp(ivec2(corner), ivec2(0), last);
  ivec2 high = clamp(ivec2(corner) + 1, ivec2(0), last);
  vec4 bottom = mix(shown_or(low, here), shown_or(ivec2(high.x, low.y), here), share.x);
  vec4 top = mix(shown_or(ivec2(low.x, high.y), here), shown_or(high, here), share.x);
  return mix(bottom, top, share.y);
}

void main()
{
  ivec2 size = textureSize(color_sums, 0);
  vec2 position = uv * vec2(size);
  ivec2 texel = clamp(ivec2(position), ivec2(0), size - 1);
  if (samples_of(texel) < 0.5) {
    discard;
  }
  out_color = smoothed > 0.5 ? shown_between(position, texel, size - 1) : shown(texel);
}
