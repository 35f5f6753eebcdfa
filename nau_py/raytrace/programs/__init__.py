"""Ray programs: the built-in ones, one file each, and the files of a project's own.

A file in ``builtin/`` describes one program (:class:`description.BuiltInProgram`): its name, kind
and documentation, the attributes that it adds to materials, the effects of light that it simulates,
and its kernel. ``catalogue`` finds the files and registers all of this: codes and dispatch of the
kernels, columns of the material tables, lint, completion and the reference derive from it.
"""
