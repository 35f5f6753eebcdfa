"""The device interfaces of OptiX 3 to 6 and of OptiX 7 and 8."""
