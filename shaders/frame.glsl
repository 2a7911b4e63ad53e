// What every pass of a frame shares. Space: y is up, the camera's target is the origin, the eye is at distance 1 from it.
layout(std140) uniform Frame {
    mat4 view_projection;
    mat4 shadow_matrix;      // to the shadow map: x, y, depth in 0..1
    vec4 sight;              // direction of the camera, w: 1 - cosine at the corners of the picture
    vec4 eye;                // w: pixels per unit of tan(angle), for lines and grids
    vec4 key_direction;      // towards the light; w: depth of the shadow map in scene units
    vec4 fill_direction;
    vec4 rim_direction;
    vec4 ground;             // x: height, y: 1 if there is one, z: radius of its effects, w: spacing of the grid (0: none)
    vec4 ground_occlusion;   // low x, low z, 1 / width, 1 / depth of the texture
    vec4 shadow_texel;       // x: width of a texel of the shadow map in scene units, y: 1 / texels, z: slope of the penumbra, w: 1 / texels of the ground shadow
};

float saturate(float v) { return clamp(v, 0.0, 1.0); }
vec3 saturate(vec3 v) { return clamp(v, vec3(0.0), vec3(1.0)); }
