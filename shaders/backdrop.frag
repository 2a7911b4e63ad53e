#include "frame.glsl"
#include "backdrop.glsl"
uniform vec3 forward;
uniform vec3 right;    // times the half width of the picture at distance 1
uniform vec3 above;
in vec2 corner;
out vec4 pixel;
void main() { pixel = vec4(dither(expose(backdrop(normalize(forward + corner.x * right + corner.y * above)))), 1.0); }
