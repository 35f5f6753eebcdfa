"""Compiled OptiX programs (NVIDIA's PTX, as nvcc writes it), run on any CPU.

``compiler`` reads PTX text and translates it to text of LLVM's language. ``optix`` adds the calls
of the device interfaces, OptiX 3 to 6 and OptiX 7 and 8. ``runtime`` turns LLVM's text into machine
code and runs launches with it; ``runtime.ll`` has the functions that programs call, such as tracing
a ray with Embree. Sources: *PTX ISA* (NVIDIA), with section numbers; the OptiX headers.
"""
