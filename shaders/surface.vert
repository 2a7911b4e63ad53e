#include "frame.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 scalar_openness;
layout(location = 3) in vec3 color;
layout(location = 4) in vec3 reference;

out vec3 world_position;
out vec3 world_normal;
out vec2 value_openness;
out vec3 base_color;
out vec3 grain_position;

void main() {
    world_position = position;
    world_normal = normal;
    value_openness = scalar_openness;
    base_color = color;
    grain_position = reference;
    gl_Position = view_projection * vec4(position, 1.0);
}
