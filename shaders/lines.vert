#include "frame.glsl"
uniform float pull;   // share of the way to the eye that lines are drawn in front of their surface
layout(location = 0) in vec3 position;
void main() {
    gl_ClipDistance[0] = position.y - ground.x;
    gl_Position = view_projection * vec4(mix(position, eye.xyz, pull), 1.0);
}
