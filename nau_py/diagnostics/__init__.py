"""Findings about a project: where, how bad, what to do; and their reporters. Knows no project."""
