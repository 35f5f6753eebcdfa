#version 330

in vec3 viewNormal;
in vec2 uv;

uniform vec4 lightDirection;
uniform vec4 lightColor;
uniform vec4 diffuse;
uniform vec4 emission;
uniform mat4 V;
uniform int texCount;
uniform sampler2D texUnit;

out vec4 outColor;

void main() {
    vec3 toLight = -normalize((V * lightDirection).xyz);
    float intensity = max(dot(normalize(viewNormal), toLight), 0.0);
    vec3 lit = (diffuse * lightColor).rgb * intensity;
    if (texCount == 0) {
        outColor = vec4(lit + diffuse.rgb * 0.3 + emission.rgb, diffuse.a);
        return;
    }
    vec4 texel = texture(texUnit, uv);
    if (texel.a <= 0.25) discard;
    outColor = vec4((lit + emission.rgb + 0.3) * texel.rgb, texel.a * diffuse.a);
}
