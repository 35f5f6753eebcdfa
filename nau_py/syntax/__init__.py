"""XML and YAML as they are written: elements, their positions, edits and cursors. No meaning.

Reading goes from text to tokens to elements. ``xml_tokens`` is the one tokeniser of Nau's XML
dialect: ``xml`` makes :class:`~nau_py.syntax.element.Element` trees of its tokens and reports
errors; ``xml_markup`` groups them into tags for ``xml_document`` (edits) and ``xml_cursor`` (the
editor's cursor), which take half-written text too. YAML is parsed by ruamel.yaml, and its marks are
the positions: ``yaml`` reads data with them, ``yaml_nodes`` and ``yaml_document`` edit by them.
Half-written YAML cannot be parsed, so ``yaml_cursor`` goes by the indentation of lines.
"""
