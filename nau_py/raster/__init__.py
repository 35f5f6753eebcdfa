"""OpenGL: everything that touches the GPU. This room does not know in which order passes run.

* ``device`` opens the context, and ``gl`` wraps the calls that moderngl lacks.
* ``resources`` makes textures, buffers, targets and programs by name, when first used.
* ``semantics`` and ``objects`` find the values of uniforms; ``draw_context`` holds what they need.
* ``draw`` binds materials and draws objects; ``hits`` runs a material's program on ray hits.
"""
