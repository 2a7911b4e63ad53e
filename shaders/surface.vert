#include "frame.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 scalar_openness;
layout(location = 3) in vec3 color;
layout(location = 4) in vec3 reference;
#ifdef INNER
layout(location = 5) in float inner;
uniform vec3 inner_color;
out float cut_open;
#endif

out vec3 world_position;
out vec3 world_normal;
out vec2 value_openness;
out vec3 base_color;
out vec3 grain_position;

void main() {
    world_position = position;
    world_normal = normal;
    value_openness = scalar_openness;
    if (ground.y > 0.5) {  // the floor near a surface is dark and sends nothing up
        float above = max(position.y - ground.x, 0.0);
        value_openness.y *= 1.0 - 0.65 * (0.5 - 0.5 * normal.y) * exp(-above * 9.0 / ground.z);
    }
    base_color = color;
#ifdef INNER
    cut_open = inner;
    base_color = mix(color, inner_color, inner);
#endif
    grain_position = reference;
    gl_ClipDistance[0] = position.y - ground.x;  // only enabled where there is a ground
    gl_Position = view_projection * vec4(position, 1.0);
}
