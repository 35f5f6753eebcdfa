"""PTX text to instructions to text of LLVM's language.

``reader`` makes a ``module`` of a text. ``translate`` writes it function by function: ``writer``
keeps registers, blocks and operands; each instruction has a handler in ``arithmetic``, ``logic``,
``bits``, ``integer`` or ``memory``. ``exports`` and ``analysis`` read without compiling.
"""
