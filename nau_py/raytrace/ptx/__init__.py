"""NVIDIA's PTX, as nvcc writes it, run natively: text to instructions to LLVM to machine code.

``reader`` reads a module; ``compile`` makes LLVM's language of it, an opcode at a time
(``arithmetic``, ``convert``, ``memory``, ``optix7``); ``native`` makes code of that. Sources:
*PTX ISA* (NVIDIA), section numbers beside what follows them; *OptiX 7* for the calls.
"""
