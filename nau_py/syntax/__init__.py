"""XML and YAML as they are written: elements with positions, edits by the character, cursors."""
