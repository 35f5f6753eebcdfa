"""Host side of compiled programs: faults, records, parameters, and the launch of a pass.

``faults`` reads the programs of a pass and executes nothing; linting uses it. ``run`` launches them
for a frame. A pass hands in values and a ``GpuAccess`` (``inputs``), so this room knows no OpenGL.
``rt_environment`` is the environment of Nau's class ``rt`` (OptiX 7, records), and
``optix_environment`` that of its class ``optix`` (OptiX 3 to 6, variables). The interface that the
programs call decides between them.
"""
