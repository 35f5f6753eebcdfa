"""Machine code of PTX modules, and launches over threads.

``layout`` has the offsets of all that programs and host share; ``native`` compiles LLVM's text;
``launch`` runs a program for every launch index; ``geometry`` builds Embree structures of geometry
that programs describe.
"""
