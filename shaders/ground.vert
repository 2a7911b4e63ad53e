#include "frame.glsl"
uniform float half_width;
out vec3 world_position;
void main() {
    vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    world_position = vec3(p.x * half_width, ground.x, -p.y * half_width);
    gl_Position = view_projection * vec4(world_position, 1.0);
}
