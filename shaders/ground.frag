// The ground has the colour of the backdrop behind it, so it has no border; light, shadow and grid fade out on it.
#include "frame.glsl"
#include "backdrop.glsl"
uniform sampler2D ground_shadow;   // with mip levels
uniform sampler2D occlusion;
in vec3 world_position;
out vec4 pixel;

// Smooth lookup in a coarse level: a cubic B-spline by four bilinear reads.
vec2 smooth_shadow(vec2 uv, float level) {
    float size = exp2(-level) / shadow_texel.w;
    vec2 p = uv * size - 0.5, i = floor(p), f = p - i;
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0, w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0, w3 = f3 / 6.0, w2 = 1.0 - w0 - w1 - w3;
    vec2 g0 = w0 + w1, g1 = w2 + w3;
    vec2 h0 = (i - 0.5 + w1 / g0) / size, h1 = (i + 1.5 + w3 / g1) / size;
    return g0.y * (g0.x * textureLod(ground_shadow, h0, level).rg + g1.x * textureLod(ground_shadow, vec2(h1.x, h0.y), level).rg)
         + g1.y * (g0.x * textureLod(ground_shadow, vec2(h0.x, h1.y), level).rg + g1.x * textureLod(ground_shadow, h1, level).rg);
}

float grid_line(float coordinate, float width) {
    float d = abs(fract(coordinate - 0.5) - 0.5);
    return 1.0 - smoothstep(0.0, width, d);
}

void main() {
    vec3 v = world_position - eye.xyz;
    float distance_to_eye = length(v);
    v /= distance_to_eye;
    float fade = 1.0 - smoothstep(0.25, 1.0, length(world_position.xz) / ground.z);

    vec3 q = (shadow_matrix * vec4(world_position, 1.0)).xyz;
    vec2 inside = step(vec2(0.0), q.xy) * step(q.xy, vec2(1.0));
    vec2 around = textureLod(ground_shadow, q.xy, 4.5).rg;
    float height = around.y / max(around.x, 1e-3) * key_direction.w;
    float level = clamp(log2(max(height * shadow_texel.z / (shadow_texel.x * shadow_texel.w / shadow_texel.y), 1.0)), 1.0, 6.0);
    float shadow = smooth_shadow(q.xy, level).x * inside.x * inside.y;

    vec2 o = (world_position.xz - ground_occlusion.xy) * ground_occlusion.zw;
    vec2 within = step(vec2(0.0), o) * step(o, vec2(1.0));
    float openness = mix(1.0, texture(occlusion, o).r, within.x * within.y);

    vec3 color = backdrop(v);
    float pool = exp(-3.0 * dot(world_position.xz, world_position.xz) / (ground.z * ground.z));
    color *= 1.0 + 0.30 * pool;
    if (ground.w > 0.0) {
        vec2 p = world_position.xz / ground.w;
        float pixels = ground.w * eye.w / distance_to_eye * max(-v.y, 0.02);  // of one cell, the narrow way
        float line = max(grid_line(p.x, 1.4 / pixels), grid_line(p.y, 1.4 / pixels)) * saturate(pixels / 12.0 - 0.4);
        color *= 1.0 - 0.10 * line * fade;
    }
    float dark = (1.0 - 0.62 * shadow) * mix(1.0, openness, 0.75);
    color *= mix(1.0, dark, saturate(fade * 1.6));
    pixel = vec4(dither(expose(color)), 1.0);
}
