// Colour, and world position with the mask: 1 if the light direction is null.
// Comes after sun.frag.

in vec3 worldPosition;
in vec3 worldNormal;
in vec2 uv;
in vec3 light;

layout(location = 0) out vec4 outColor;
layout(location = 1) out vec4 outPosition;

void main() {
    if (dot(light, light) == 0.0) {
        outColor = vec4(0.0, 0.0, 0.0, 1.0);
        outPosition = vec4(worldPosition, 1.0);
        return;
    }
    vec4 t = texel(uv);
    if (t.a <= 0.25) discard;
    vec3 colour = underTheSun(worldPosition, normalize(worldNormal), light, diffuse.rgb * t.rgb);
    outColor = vec4(colour, 1.0);
    outPosition = vec4(worldPosition, 0.0);
}
