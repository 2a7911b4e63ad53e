// Puts the scene, drawn alone with several samples a pixel and resolved to its mean and coverage (premultiplied), over the studio.
uniform sampler2D scene;
out vec4 pixel;
void main() { pixel = texelFetch(scene, ivec2(gl_FragCoord.xy), 0); }
