def lint(p): return []
