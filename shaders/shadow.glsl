uniform sampler2DShadow shadow_map;

// Share of the key light that reaches p: four bilinear comparisons, together a smooth filter about four texels wide.
float key_light_reaching(vec3 p, vec3 normal) {
    // A step along the normal, larger where light grazes, keeps the surface from shading itself.
    float grazing = 1.0 - saturate(dot(normal, key_direction.xyz));
    vec3 q = (shadow_matrix * vec4(p + normal * shadow_texel.x * (1.0 + 2.5 * grazing), 1.0)).xyz;
    float h = 0.75 * shadow_texel.y;
    q.z -= 0.0004;
    return 0.25 * (texture(shadow_map, q + vec3(-h, -h, 0.0)) + texture(shadow_map, q + vec3(h, -h, 0.0)) +
                   texture(shadow_map, q + vec3(-h, h, 0.0)) + texture(shadow_map, q + vec3(h, h, 0.0)));
}
