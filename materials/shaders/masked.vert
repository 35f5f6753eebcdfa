#version 330

// Geometry that is traced: its light direction is null.

in vec4 position;
in vec4 normal;
in vec4 texCoord0;

uniform mat4 PVM;
uniform mat4 model;

out vec3 worldPosition;
out vec3 worldNormal;
out vec2 uv;
out vec3 light;

void main() {
    worldPosition = (model * position).xyz;
    worldNormal = mat3(model) * normal.xyz;
    uv = texCoord0.xy;
    light = vec3(0.0);
    gl_Position = PVM * position;
}
