#version 330

// What the mask pass sees: world position and the number of the material.

uniform mat4 PVM;
uniform mat4 M;

in vec4 position;

out vec3 worldPosition;

void main()
{
	worldPosition = vec3(M * position);
	gl_Position = PVM * position;
}
