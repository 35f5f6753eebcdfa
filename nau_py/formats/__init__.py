"""Files to models and back: XML in Nau's dialect, YAML, material libraries, upgrades.

Decides no meaning: what it does not know is kept for lint to report.
"""

from nau_py.formats.load import load_project

__all__ = ["load_project"]
