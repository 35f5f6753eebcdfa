#version 330

in vec4 position;
in vec4 texCoord0;

uniform mat4 PVM;

out vec2 uv;

void main() {
    uv = texCoord0.xy;
    gl_Position = PVM * position;
}
