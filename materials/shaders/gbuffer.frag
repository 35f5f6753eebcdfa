#version 330

// Colour, and world position with the mask: 1 where the light direction is null.

in vec3 worldPosition;
in vec3 worldNormal;
in vec2 uv;
in vec3 light;

uniform vec4 lightColor;
uniform vec4 diffuse;
uniform vec4 emission;
uniform int texCount;
uniform sampler2D texUnit;

layout(location = 0) out vec4 outColor;
layout(location = 1) out vec4 outPosition;

void main() {
    if (dot(light, light) == 0.0) {
        outColor = vec4(0.0, 0.0, 0.0, 1.0);
        outPosition = vec4(worldPosition, 1.0);
        return;
    }
    vec4 texel = texCount == 0 ? vec4(1.0) : texture(texUnit, uv);
    if (texel.a <= 0.25) discard;
    vec3 base = diffuse.rgb * texel.rgb;
    float cosine = max(dot(normalize(worldNormal), -normalize(light)), 0.0);
    outColor = vec4(base * (lightColor.rgb * cosine + 0.3) + emission.rgb, 1.0);
    outPosition = vec4(worldPosition, 0.0);
}
