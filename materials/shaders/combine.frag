#version 330

// Traced colour if the 4th component of the position is 1, else the rasterised colour.

uniform sampler2D raster;
uniform sampler2D position;
uniform sampler2D traced;

out vec4 outColor;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float mask = texelFetch(position, pixel, 0).w;
    vec3 colour = mix(texelFetch(raster, pixel, 0).rgb, texelFetch(traced, pixel, 0).rgb, mask);
    outColor = vec4(colour, 1.0);
}
