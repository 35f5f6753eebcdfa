"""Rules over a project's data: nothing is executed, no GL context is made.

Empty on purpose: :func:`nau_py.lint` is the function, and this package must be importable first
without loading any rule.
"""
