"""Generators of documentation; not shipped."""
