"""Raytrace passes that launch compiled OptiX programs: PTX, run natively on any CPU (7.1, 7.2).

``faults`` reads them only; ``execute`` runs them. ``rt`` is the environment of Nau's class ``rt``
(OptiX 7: records), ``optix`` that of its class ``optix`` (OptiX 3 to 6: variables); which one it
is, the programs tell.
"""
