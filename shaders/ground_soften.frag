// The soft shadow on the ground, once for each place of it: the higher what casts it, the coarser the mip level it is read from.
#include "frame.glsl"
uniform sampler2D ground_mask;
in vec2 corner;
out float shadow;

// Smooth lookup in one whole level: a cubic B-spline by four bilinear reads.
vec2 smooth_mask(vec2 uv, float level) {
    float size = exp2(-level) / shadow_texel.w;
    vec2 p = uv * size - 0.5, i = floor(p), f = p - i;
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0, w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0, w3 = f3 / 6.0, w2 = 1.0 - w0 - w1 - w3;
    vec2 g0 = w0 + w1, g1 = w2 + w3;
    vec2 h0 = (i - 0.5 + w1 / g0) / size, h1 = (i + 1.5 + w3 / g1) / size;
    return g0.y * (g0.x * textureLod(ground_mask, h0, level).rg + g1.x * textureLod(ground_mask, vec2(h1.x, h0.y), level).rg)
         + g1.y * (g0.x * textureLod(ground_mask, vec2(h0.x, h1.y), level).rg + g1.x * textureLod(ground_mask, h1, level).rg);
}

void main() {
    vec2 uv = 0.5 * corner + 0.5;
    vec2 around = smooth_mask(uv, 4.0);
    float height = around.y / (around.x + 0.002) * key_direction.w;
    float texel = shadow_texel.x * shadow_texel.w / shadow_texel.y;
    float level = clamp(log2(1.0 + height * shadow_texel.z / texel) + 0.6, 0.8, 5.0);
    float whole = floor(level);  // the grid of the spline is that of a level: between two levels, mix two splines
    shadow = mix(smooth_mask(uv, whole).x, smooth_mask(uv, whole + 1.0).x, level - whole);
}
