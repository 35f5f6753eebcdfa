#version 330

in vec4 position;
in vec4 normal;
in vec4 texCoord0;

uniform mat4 PVM;
uniform mat3 NormalMatrix;

out vec3 viewNormal;
out vec2 uv;

void main() {
    viewNormal = normalize(NormalMatrix * normal.xyz);
    uv = texCoord0.xy;
    gl_Position = PVM * position;
}
