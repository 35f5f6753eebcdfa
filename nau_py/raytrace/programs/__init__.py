"""Ray programs that nau_py brings, and where a project's own ones are."""
