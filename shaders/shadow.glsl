uniform sampler2DShadow shadow_map;

// Share of the key light that reaches p, by comparing at twelve places of a disc (Vogel's spiral); each comparison is bilinear.
const vec2 kDisc[12] = vec2[12](
    vec2(0.204, 0.000), vec2(-0.261, 0.239), vec2(0.040, -0.455), vec2(0.329, 0.429), vec2(-0.603, -0.107), vec2(0.572, -0.364),
    vec2(-0.195, 0.710), vec2(-0.363, -0.702), vec2(0.800, 0.258), vec2(-0.826, 0.337), vec2(0.359, -0.864), vec2(0.346, 0.916));

float key_light_reaching(vec3 p, vec3 normal) {
    // A step along the normal, larger where light grazes, keeps the surface from shading itself.
    float grazing = 1.0 - saturate(dot(normal, key_direction.xyz));
    vec3 q = (shadow_matrix * vec4(p + normal * shadow_texel.x * (1.5 + 3.0 * grazing), 1.0)).xyz;
    float radius = 2.6 * shadow_texel.y;
    float light = 0.0;
    for (int i = 0; i < 12; ++i) light += texture(shadow_map, vec3(q.xy + kDisc[i] * radius, q.z - 0.0004));
    return light / 12.0;
}
