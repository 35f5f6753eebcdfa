"""Lint rules over the data of a project. Nothing is executed and no GL context is made.

One module a family of rules registers them with their checks; :mod:`nau_py.rules.engine` runs all
checks. This module imports nothing, so that a plug-in can import the registry alone.
"""
