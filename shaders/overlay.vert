layout(location = 0) in vec2 position;   // pixels from the upper left
layout(location = 1) in vec2 texel;      // of the font atlas
layout(location = 2) in vec4 color;
layout(location = 3) in vec3 box;        // pixels from the middle of a rounded box; z: radius of its corners, below zero for glyphs
layout(location = 4) in vec2 half_size;
uniform vec2 picture_size;
out vec2 uv;
out vec4 tint;
out vec3 from_middle;
flat out vec2 extent;
void main() {
    uv = texel;
    tint = color;
    from_middle = box;
    extent = half_size;
    gl_Position = vec4(2.0 * position / picture_size - 1.0, 0.0, 1.0);
    gl_Position.y = -gl_Position.y;
}
