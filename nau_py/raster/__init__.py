"""OpenGL: device, programs, uniforms, states, textures, targets, drawing. Knows no pass order."""
