"""PTX text to instructions to LLVM's language."""
