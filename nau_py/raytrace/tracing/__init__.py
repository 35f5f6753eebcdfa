"""Host side of ray tracing: scene tables, tiles over threads, estimates, users' programs."""
