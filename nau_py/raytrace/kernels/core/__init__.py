"""Decorators, memory, vectors, tables and random numbers of kernels."""
