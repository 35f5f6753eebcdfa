#version 330

// Depth only; the holes of alpha textures let the light through.

in vec2 uv;

uniform int texCount;
uniform sampler2D texUnit;

void main() {
    if (texCount != 0 && texture(texUnit, uv).a <= 0.25) discard;
}
