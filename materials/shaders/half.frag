// Colour, and world position with the mask: 1 in the lower half of the target.
// Comes after sun.frag.

in vec3 worldPosition;
in vec3 worldNormal;
in vec2 uv;
in vec3 light;

uniform vec2 targetSize;

layout(location = 0) out vec4 outColor;
layout(location = 1) out vec4 outPosition;

void main() {
    float mask = gl_FragCoord.y < targetSize.y * 0.5 ? 1.0 : 0.0;
    vec4 t = texel(uv);
    if (mask == 0.0 && t.a <= 0.25) discard;
    vec3 colour = underTheSun(worldPosition, normalize(worldNormal), light, diffuse.rgb * t.rgb);
    outColor = vec4(colour, 1.0);
    outPosition = vec4(worldPosition, mask);
}
