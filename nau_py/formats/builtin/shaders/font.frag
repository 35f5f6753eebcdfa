#version 330

in vec2 uv;

uniform vec4 emission;
uniform sampler2D texUnit;

out vec4 outColor;

void main() {
    outColor = emission * texture(texUnit, uv);
}
