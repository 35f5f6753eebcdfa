#version 330

// Linear radiance to the screen: the transfer function of sRGB (IEC 61966-2-1).

uniform sampler2D radiance;

out vec4 outColor;

void main() {
    vec3 traced = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb;
    if (any(isnan(traced))) {
        outColor = vec4(1.0, 0.0, 1.0, 1.0);
        return;
    }
    vec3 linear = clamp(traced, 0.0, 1.0);
    vec3 curved = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    outColor = vec4(mix(curved, 12.92 * linear, lessThan(linear, vec3(0.0031308))), 1.0);
}
