"""nau_py."""
