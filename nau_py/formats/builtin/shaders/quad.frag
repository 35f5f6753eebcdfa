#version 330

in vec2 uv;

uniform sampler2D texUnit;

out vec4 outColor;

void main() {
    outColor = texture(texUnit, uv);
}
