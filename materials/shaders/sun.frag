#version 330

// Shared by the hybrid shaders: the texel of a surface, and its colour under the sun with the
// shadow map. The ray programs of the demos compute the same with shadow rays.

uniform vec4 lightColor;
uniform vec4 diffuse;
uniform vec4 emission;
uniform int texCount;
uniform sampler2D texUnit;
uniform sampler2DShadow shadowMap;
uniform mat4 sunMatrix;

const float AMBIENT = 0.3;
const float NORMAL_OFFSET = 0.03;
const float BIAS = 0.0003;

vec4 texel(vec2 uv) {
    return (texCount & 1) == 0 ? vec4(1.0) : texture(texUnit, uv);
}

// One comparison, filtered by the texture unit: rays give hard shadows too.
float seenBySun(vec3 position, vec3 normal) {
    vec3 p = (sunMatrix * vec4(position + normal * NORMAL_OFFSET, 1.0)).xyz;
    return texture(shadowMap, vec3(p.xy, p.z - BIAS));
}

vec3 underTheSun(vec3 position, vec3 normal, vec3 light, vec3 base) {
    float cosine = max(dot(normal, -normalize(light)), 0.0);
    float seen = cosine > 0.0 ? seenBySun(position, normal) : 0.0;
    return base * (lightColor.rgb * cosine * seen + AMBIENT) + emission.rgb;
}
