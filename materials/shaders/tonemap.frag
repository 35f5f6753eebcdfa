#version 330

// Exposure, Reinhard's global operator with a white point (Reinhard et al. 2002, equation 4), and the
// transfer function of sRGB (IEC 61966-2-1).

uniform sampler2D radiance;

out vec4 outColor;

const float EXPOSURE = 0.5;
const float WHITE = 3.0;

void main() {
    vec3 traced = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb;
    if (any(isnan(traced))) {
        outColor = vec4(1.0, 0.0, 1.0, 1.0);
        return;
    }
    vec3 l = max(traced, 0.0) * EXPOSURE;
    float bright = dot(l, vec3(0.2126, 0.7152, 0.0722));
    float mapped = bright * (1.0 + bright / (WHITE * WHITE)) / (1.0 + bright);
    vec3 linear = clamp(l * (mapped / max(bright, 1e-6)), 0.0, 1.0);
    vec3 curved = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    outColor = vec4(mix(curved, 12.92 * linear, lessThan(linear, vec3(0.0031308))), 1.0);
}
