uniform sampler2D font;
in vec2 uv;
in vec4 tint;
in vec3 from_middle;
flat in vec2 extent;
out vec4 pixel;
void main() {
    float coverage = texture(font, uv).r;
    if (from_middle.z >= 0.0) {  // distance to a rounded box
        vec2 d = abs(from_middle.xy) - extent + from_middle.z;
        coverage = clamp(0.5 - (length(max(d, vec2(0.0))) + min(max(d.x, d.y), 0.0) - from_middle.z), 0.0, 1.0);
    }
    pixel = vec4(tint.rgb, tint.a * coverage);
}
