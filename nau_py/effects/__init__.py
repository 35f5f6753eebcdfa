"""Effects on demand: facts of a scene, the effects that it calls for, the decision on each one."""
