"""The nouns of a project: one class an element of a project file.

Markers on the fields give each class one description (:mod:`nau_py.model.schema`), from which
reading, writing, lint, completion and the reference page derive. The model reads no files and makes
no pictures.
"""
