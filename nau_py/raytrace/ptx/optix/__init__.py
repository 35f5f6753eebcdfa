"""OptiX as programs see it: calls of its device interfaces, variables and records.

``compile`` translates a module with these calls; ``optix7`` has those of OptiX 7 and 8, ``optix6``
those of OptiX 3 to 6, whose ``variables`` are bound by name. ``records`` are those of class ``rt``.
"""
