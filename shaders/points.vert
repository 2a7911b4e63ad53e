#include "frame.glsl"
uniform float size;   // [pixels]
layout(location = 0) in vec3 position;
layout(location = 1) in float value;
out float point_value;
void main() {
    point_value = value;
    gl_ClipDistance[0] = position.y - ground.x;
    gl_Position = view_projection * vec4(position, 1.0);
    gl_PointSize = size;
}
