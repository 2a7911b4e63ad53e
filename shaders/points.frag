// A small ball for each point, lit just enough to look round: the colour carries the number.
uniform sampler2D color_table;
uniform vec2 value_range;   // low, 1 / (high - low)
in float point_value;
out vec4 pixel;
void main() {
    vec2 p = 2.0 * gl_PointCoord - 1.0;
    float r2 = dot(p, p);
    if (r2 > 1.0) discard;
    vec3 color = point_value < -1e29 ? vec3(0.25)
               : texture(color_table, vec2(clamp((point_value - value_range.x) * value_range.y, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
    pixel = vec4(color * (0.62 + 0.38 * sqrt(1.0 - r2)), 1.0);
}
