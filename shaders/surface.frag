// Surfaces. One program for each look: LOOK is 0 tissue, 1 rubber, 2 gel, 3 metal, 4 paint; MAPPED colours by the scalar, GRAIN adds the
// texture of tissue, INNER tells faces that a cut laid open. Specular: GGX with Smith's height-correlated visibility (E. Heitz, JCGT 3(2), 2014) and Schlick's Fresnel term.
#include "frame.glsl"
#include "backdrop.glsl"
#include "shadow.glsl"

in vec3 world_position;
in vec3 world_normal;
in vec2 value_openness;
in vec3 base_color;
in vec3 grain_position;
#ifdef INNER
in float cut_open;  // 1 on faces that a cut laid open
#endif

uniform sampler2D color_table;
uniform vec2 value_range;   // low, 1 / (high - low)

uniform float opacity;
#ifdef FLAT
uniform samplerBuffer triangle_values;
#endif

out vec4 pixel;

const float kPi = 3.14159265;

float ggx(float n_h, float alpha) {
    float d = n_h * n_h * (alpha * alpha - 1.0) + 1.0;
    return alpha * alpha / (kPi * d * d);
}

float visibility(float n_v, float n_l, float alpha) {
    float a2 = alpha * alpha;
    return 0.5 / max(n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2), 1e-4);
}

float schlick(float c) {
    float m = 1.0 - saturate(c);
    return m * m * m * m * m;
}

vec3 specular(vec3 n, vec3 v, vec3 l, float alpha, vec3 f0) {
    vec3 h = normalize(l + v);
    float n_l = saturate(dot(n, l)), n_v = abs(dot(n, v)) + 1e-3;
    vec3 f = f0 + (1.0 - f0) * schlick(dot(v, h));
    return f * (ggx(saturate(dot(n, h)), alpha) * visibility(n_v, n_l, alpha) * n_l);
}

// Diffuse light that creeps around the edge of the shadow by `wrap` of each colour; keeps the energy.
vec3 wrapped(float n_l, vec3 wrap) { return saturate((vec3(n_l) + wrap) / ((1.0 + wrap) * (1.0 + wrap))); }

#ifdef GRAIN
uniform sampler3D noise;
#endif

const vec3 kKeyColor = vec3(1.85, 1.76, 1.62);
const vec3 kFillColor = vec3(0.26, 0.31, 0.38);
const vec3 kRimColor = vec3(1.00, 1.12, 1.30);

// Light from everywhere: sky above, floor below, both dimmed where matter is near.
vec3 ambient(vec3 n, float openness) {
    vec3 sky = vec3(0.30, 0.335, 0.39), floor_light = vec3(0.15, 0.145, 0.14);
    return mix(floor_light, sky, 0.5 + 0.5 * n.y) * openness;
}

#ifdef MAPPED
// The colour carries the number: shading stays gentle and grey, or the lightness of the map would be misread.
vec3 shade_mapped(vec3 n, vec3 v, float light, float openness) {
#ifdef FLAT
    float value = texelFetch(triangle_values, gl_PrimitiveID).x;
#else
    float value = value_openness.x;
#endif
    vec3 albedo = value < -1e29 ? vec3(0.25) : texture(color_table, vec2(saturate((value - value_range.x) * value_range.y) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
    float key = 0.62 * wrapped(dot(n, key_direction.xyz), vec3(0.35)).x * mix(0.30, 1.0, light);
    float fill = 0.16 * wrapped(dot(n, fill_direction.xyz), vec3(0.5)).x;
    float around = (0.42 + 0.14 * n.y) * openness;
    vec3 gloss = specular(n, v, key_direction.xyz, 0.16, vec3(0.03)) * 0.55 * light;
    float edge = schlick(dot(n, v)) * saturate(dot(n, rim_direction.xyz) + 0.3);
    return albedo * (key * 1.5 + fill + around) + gloss + vec3(0.15, 0.16, 0.18) * edge * openness;
}
#endif

vec3 shade(vec3 n, vec3 v, float light, float openness) {
    vec3 albedo = base_color, f0 = vec3(0.04), wrap = vec3(0.0);
    float alpha = 0.25, coat_alpha = 0.0, coat = 0.0;
#if LOOK == 0  // wet tissue: red light travels furthest below the surface; a thin film of water on top
    wrap = vec3(0.50, 0.16, 0.12);
    alpha = 0.30; coat = 1.0; coat_alpha = 0.045;
    vec3 bumped = n;
#ifdef GRAIN
    // One read gives four independent noises; the texture repeats after 32 of its steps.
    float coarse = texture(noise, grain_position * (9.0 / 32.0)).r;
    vec4 fine = texture(noise, grain_position * (37.0 / 32.0));
    albedo *= 0.70 + 0.42 * coarse + 0.20 * fine.r;
    albedo = mix(albedo, albedo * vec3(1.25, 1.15, 0.85), 0.5 * smoothstep(0.55, 0.9, coarse));
    bumped = normalize(n + 0.075 * (fine.gba - 0.5));
#endif
#elif LOOK == 1  // rubber
    vec3 bumped = n;
    alpha = 0.36; wrap = vec3(0.10);
#elif LOOK == 2  // gel: light passes, edges are brighter and denser
    vec3 bumped = n;
    wrap = vec3(0.65); alpha = 0.12; coat = 0.8; coat_alpha = 0.02;
#elif LOOK == 3  // metal
    vec3 bumped = n;
    f0 = albedo; albedo = vec3(0.0); alpha = 0.10;
#else            // paint: tools, arrows
    vec3 bumped = n;
    albedo *= 0.78; alpha = 0.16; wrap = vec3(0.15);
#endif
#if defined(INNER) && LOOK == 0  // no capsule: a cut mirrors the opposite lip, not the sky
    coat *= 1.0 - 0.75 * cut_open;
    alpha = mix(alpha, 0.5, cut_open);
#endif
    vec3 l = key_direction.xyz;
    vec3 soft_light = mix(vec3(light), vec3(sqrt(light), light, light), saturate(wrap.r * 1.4));  // shadows on flesh have red edges
    vec3 diffuse = kKeyColor * wrapped(dot(n, l), wrap) * soft_light + kFillColor * wrapped(dot(n, fill_direction.xyz), max(wrap, vec3(0.3))) * openness
                 + kRimColor * 0.35 * wrapped(dot(n, rim_direction.xyz), wrap) * openness + ambient(n, openness);
    vec3 color = albedo * diffuse;
    float n_v = saturate(dot(bumped, v));
#if LOOK == 2
    float through = pow(saturate(dot(v, -normalize(l + 0.45 * n))), 3.0);
    color += albedo * albedo * (1.6 * through + 0.55 * (1.0 - n_v) * (1.0 - n_v)) * openness;
#endif
    vec3 around = reflect(-v, bumped);
    float roughness = sqrt(alpha);
    // What is reflected comes from the open side only, and less of it from below where the ground is dark.
    float seen = mix(openness * openness, 1.0, 0.25);
    vec3 f_view = f0 + (max(vec3(1.0 - roughness), f0) - f0) * schlick(n_v);
    color += specular(bumped, v, l, alpha, f0) * kKeyColor * light;
    color += specular(bumped, v, rim_direction.xyz, alpha, f0) * kRimColor * openness;
#if LOOK != 0 && LOOK != 2  // where there is a coat, it is what mirrors
    color += studio(around, roughness) * f_view * seen * (LOOK == 3 ? 1.0 : 0.35);
#endif
    if (coat > 0.0) {
        float c = coat * (0.035 + 0.965 * schlick(n_v));
        color = color * (1.0 - c) + studio(around, 0.12) * c * seen * 0.8
              + specular(bumped, v, l, coat_alpha, vec3(0.02)) * kKeyColor * coat * light * 0.6;
    }
#if LOOK == 4
    color += base_color * 0.12;  // annotations stay visible in the shadow
#endif
    return color;
}

void main() {
    vec3 v = normalize(eye.xyz - world_position);
    vec3 n = normalize(gl_FrontFacing ? world_normal : -world_normal);
    float openness = value_openness.y;
    // Where the surface turns away from the light, its own falloff is the shadow; the map would only add its steps.
    float light = mix(key_light_reaching(world_position, n), 1.0, smoothstep(0.12, -0.12, dot(n, key_direction.xyz)));
#ifdef MAPPED
    vec3 color = shade_mapped(n, v, light, openness);
#else
    vec3 color = shade(n, v, light, openness);
#endif
    pixel = vec4(expose(color), opacity);
}
