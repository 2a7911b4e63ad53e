uniform mat4 to_light;
layout(location = 0) in vec3 position;
void main() { gl_Position = to_light * vec4(position, 1.0); }
