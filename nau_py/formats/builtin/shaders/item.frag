#version 330

uniform vec4 item;

in vec3 worldPosition;

out vec4 seen;

void main()
{
	seen = vec4(worldPosition, item.x);
}
