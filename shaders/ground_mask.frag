// Seen from the light: which places of the ground are in the shadow (red), and how far above them, along the light, is what casts it (green,
// times red). Mip levels of this picture are the soft shadow: the higher the caster, the coarser the level.
#include "frame.glsl"
uniform sampler2D shadow_depth;
uniform vec3 ground_depth;   // depth of the ground plane in the shadow map = x + y * u + z * v
in vec2 corner;
out vec2 shadow;

void main() {
    vec2 uv = 0.5 * corner + 0.5;
    float here = ground_depth.x + ground_depth.y * uv.x + ground_depth.z * uv.y;
    ivec2 t = 2 * ivec2(gl_FragCoord.xy);  // this picture has half the width of the shadow map
    vec4 caster = vec4(texelFetch(shadow_depth, t, 0).r, texelFetch(shadow_depth, t + ivec2(1, 0), 0).r,
                       texelFetch(shadow_depth, t + ivec2(0, 1), 0).r, texelFetch(shadow_depth, t + ivec2(1, 1), 0).r);
    vec4 hidden = step(caster + 0.0005, vec4(here)) * step(caster, vec4(0.99999));
    vec4 height = hidden * max(vec4(here) - caster, vec4(0.0));
    shadow = vec2(dot(hidden, vec4(0.25)), saturate(dot(height, vec4(0.25))));
}
