#version 330

// World space: rasterises as the built-in ray programs phong and blinn_phong shade.

in vec4 position;
in vec4 normal;
in vec4 texCoord0;

uniform mat4 PVM;
uniform mat4 model;

out vec3 worldPosition;
out vec3 worldNormal;
out vec2 uv;

void main() {
    worldPosition = (model * position).xyz;
    worldNormal = transpose(inverse(mat3(model))) * normal.xyz;
    uv = texCoord0.xy;
    gl_Position = PVM * position;
}
