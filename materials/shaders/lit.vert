#version 330

// Geometry that the rasteriser shades: the light direction goes on to the fragment shader.

in vec4 position;
in vec4 normal;
in vec4 texCoord0;

uniform mat4 PVM;
uniform mat4 model;
uniform vec4 lightDirection;

out vec3 worldPosition;
out vec3 worldNormal;
out vec2 uv;
out vec3 light;

void main() {
    worldPosition = (model * position).xyz;
    worldNormal = mat3(model) * normal.xyz;
    uv = texCoord0.xy;
    light = lightDirection.xyz;
    gl_Position = PVM * position;
}
