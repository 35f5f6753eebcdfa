"""Help in the editor: completion, hover, navigation, rename and fixes; functions over texts.

Nothing of a project is executed. :mod:`nau_py.lsp.server` speaks the Language Server Protocol;
the other modules do not know it.
"""
