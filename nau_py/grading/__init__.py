"""Projects of other people: each in processes of its own, one page for all."""
