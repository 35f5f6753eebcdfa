"""Effects on demand: what a scene calls for, and what is left out for which reason."""
