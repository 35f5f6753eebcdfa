"""The built-in ray programs, one file each: ``PROGRAM`` describes it."""
