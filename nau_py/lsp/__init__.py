"""Help in the editor: completion, hover, navigation, rename and fixes. No project is executed.

:mod:`nau_py.lsp.session` keeps the open texts and loads projects with them. ``complete``, ``hover``
and ``navigate`` answer questions about a character of a text; they use ``place`` (the grammar),
``symbols`` (the names of a project) and ``links`` (the files that it names). ``server``,
``language_server`` and ``ranges`` alone know the Language Server Protocol.
"""
