"""Native code of PTX modules, and launches over threads."""
