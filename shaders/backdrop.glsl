// The studio around the scene: floor, horizon and sky melt into each other. Linear light.
const vec3 kSkyColor = vec3(0.040, 0.052, 0.072);
const vec3 kHorizonColor = vec3(0.250, 0.290, 0.335);
const vec3 kFloorColor = vec3(0.132, 0.145, 0.162);

vec3 backdrop(vec3 direction) {
    float h = direction.y;
    vec3 above = mix(kHorizonColor, kSkyColor, smoothstep(-0.05, 0.50, h));
    vec3 below = mix(kHorizonColor, kFloorColor, smoothstep(0.0, 0.55, -h));
    return h > 0.0 ? above : below;
}

// Corners a little darker: the eye stays in the middle.
float vignette(vec3 direction) {
    float off = (1.0 - dot(direction, sight.xyz)) / sight.w;
    return 1.0 - 0.38 * off;
}

// What a glossy surface mirrors: the backdrop, a soft box over the key light, a strip behind, dim floor. Rough surfaces see it blurred.
vec3 studio(vec3 r, float roughness) {
    float blur = 0.08 + roughness;
    vec3 base = mix(vec3(0.16, 0.155, 0.15), vec3(0.50, 0.56, 0.64), smoothstep(-blur, blur + 0.25, r.y));
    float key_box = smoothstep(0.80 - 0.5 * blur, 0.93 + 0.3 * blur, dot(r, key_direction.xyz));
    float strip = smoothstep(0.75 - 0.5 * blur, 0.95 + 0.3 * blur, dot(r, rim_direction.xyz));
    return base + key_box * vec3(2.6, 2.5, 2.35) / (1.0 + 2.0 * roughness) + strip * vec3(1.3, 1.45, 1.6) / (1.0 + 2.0 * roughness);
}

// Leaves shades up to 0.7 alone and bends the rest below 1, so that highlights keep their colour.
vec3 expose(vec3 c) {
    vec3 over = max(c - 0.7, vec3(0.0));
    return min(c, vec3(0.7)) + 0.3 * over / (0.3 + over);
}

// Half a level of ordered noise: a slow gradient would show bands in eight bits.
vec3 dither(vec3 c) {
    ivec2 p = ivec2(gl_FragCoord.xy) & 3;
    int bayer = (((p.x ^ p.y) & 1) << 3) | ((p.y & 1) << 2) | (((p.x ^ p.y) & 2) << 0) | ((p.y & 2) >> 1);
    float level = (float(bayer) + 0.5) / 16.0 - 0.5;
    return c + level / 255.0 * max(2.0 * sqrt(max(c, vec3(0.0))), vec3(0.08));
}
