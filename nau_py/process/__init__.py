"""Files and child processes: guarded paths, whole writes, limits, isolation."""
