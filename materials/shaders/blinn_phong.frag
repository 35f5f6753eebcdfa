#version 330

// Nau's default look by the first light, plus SPECULAR times a highlight: docs/effects.

uniform vec4 lightDirection;
uniform vec4 lightColor;
uniform vec4 eye;
uniform vec4 diffuse;
uniform vec4 specular;
uniform vec4 emission;
uniform float shininess;
uniform int texCount;
uniform sampler2D texUnit;

in vec3 worldPosition;
in vec3 worldNormal;
in vec2 uv;

out vec4 outColor;

const float AMBIENT = 0.3;

float highlight(vec3 n, vec3 l, vec3 e) {
    return dot(normalize(l + e), n);
}

void main() {
    vec3 n = normalize(worldNormal);
    vec3 e = normalize(eye.xyz - worldPosition);
    if (dot(n, e) < 0.0) n = -n;
    vec3 l = -normalize(lightDirection.xyz);
    bool textured = (texCount & 1) != 0;
    vec3 t = textured ? texture(texUnit, uv).rgb : vec3(1.0);
    vec3 rest = textured ? vec3(AMBIENT) : AMBIENT * diffuse.rgb;
    vec3 colour = (rest + emission.rgb) * t;
    float cosine = dot(n, l);
    if (cosine > 0.0) {
        colour += diffuse.rgb * lightColor.rgb * cosine * t;
        float lobe = highlight(n, l, e);
        if (lobe > 0.0) colour += specular.rgb * lightColor.rgb * pow(lobe, shininess);
    }
    outColor = vec4(colour, 1.0);
}
