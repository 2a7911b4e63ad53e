// Backdrop and ground in one pass: a ray through the pixel meets the ground or does not. The ground has the colour of the backdrop behind it,
// so it has no border; light, shadow and grid fade out on it.
#include "frame.glsl"
#include "backdrop.glsl"
uniform sampler2D ground_shadow;   // softened, in the space of the shadow map
uniform sampler2D occlusion;
uniform vec3 forward;
uniform vec3 right;    // times the half width of the picture at distance 1
uniform vec3 above;
in vec2 corner;
out vec4 pixel;

float grid_line(float coordinate, float width) {
    float d = abs(fract(coordinate - 0.5) - 0.5);
    return 1.0 - smoothstep(0.0, width, d);
}

// 1 within a texture, 0 outside
float inside(vec2 uv) {
    vec2 d = abs(uv - 0.5);
    return step(max(d.x, d.y), 0.5);
}

vec3 ground_tint(vec3 world, float distance_to_eye, float down) {
    float from_middle = dot(world.xz, world.xz) / (ground.z * ground.z);
    float fade = 1.0 - smoothstep(0.06, 1.0, from_middle);
    vec2 uv = (shadow_matrix * vec4(world, 1.0)).xy;
    float shadow = texture(ground_shadow, uv).r * inside(uv);
    vec2 o = (world.xz - ground_occlusion.xy) * ground_occlusion.zw;
    float openness = mix(1.0, texture(occlusion, o).r, 0.75 * inside(o) * step(1e-9, ground_occlusion.z));
    vec2 p = world.xz / ground.w;
    float pixels = ground.w * eye.w / distance_to_eye * max(down, 0.02);  // of one cell, the narrow way
    float line = max(grid_line(p.x, 1.4 / pixels), grid_line(p.y, 1.4 / pixels)) * saturate(pixels / 12.0 - 0.4);
    float tint = (1.0 - 0.64 * shadow) * openness * (1.0 - 0.10 * line) * (1.0 + 0.46 * exp(-3.0 * from_middle));
    return vec3(mix(1.0, tint, fade));
}

void main() {
    vec3 ray = forward + corner.x * right + corner.y * above;
    float inverse_length = inversesqrt(dot(ray, ray));
    vec3 direction = ray * inverse_length;
    vec3 color = backdrop(direction) * vignette(direction);
#ifdef GROUND
    float down = max(-ray.y, 1e-4);
    float t = (eye.y - ground.x) / down;
    if (ray.y < 0.0) color *= ground_tint(eye.xyz + t * ray, t / inverse_length, down * inverse_length);
#endif
    pixel = vec4(dither(expose(color)), 1.0);
}
