#version 330

in vec2 uv;

uniform vec4 emission;
uniform int texCount;
uniform sampler2D texUnit;

out vec4 outColor;

void main() {
    outColor = texCount == 0 ? emission : emission * emission * texture(texUnit, uv);
}
