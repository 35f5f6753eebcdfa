"""The frame loop, its clock, what it captures and what it reports."""
