"""The graph of a pipeline: passes, the resources that they exchange, and the plan of a run.

Three stages, each a pure function of the one before. None needs a GL context or draws.

1. ``contract``: a pass class reports what a pass reads and writes (:class:`Access`).
2. ``dependencies``: from these lists, which pass must run after which. Plain data, because
   ``nau-lint`` uses it and must not wait for networkx to be imported.
3. ``plan``: which passes run, and why the others do not.

:attr:`Plan.graph` is the same knowledge as a ``networkx.DiGraph``; ``network`` builds it and
answers questions of order, cycles, reduction and critical path with networkx. ``layout``,
``picture`` and ``export`` turn that graph into positions, SVG, DOT, Mermaid and JSON.
"""

from nau_py.graph.plan import Plan, make_plan
from nau_py.graph.step import Step

__all__ = ["Plan", "Step", "make_plan"]
