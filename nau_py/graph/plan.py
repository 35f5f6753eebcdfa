"""The plan of a pipeline: the passes that run, in order, and why the others do not."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from nau_py.graph.contract import Contracts
from nau_py.graph.dependencies import Dependencies, find_dependencies
from nau_py.graph.resource import WINDOW, Resource
from nau_py.graph.step import Step
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline

if TYPE_CHECKING:
    from nau_py.graph.network import Network


@dataclass(slots=True)
class Plan:
    """A pipeline's passes in the order of their run. A pure value: it needs no GL context."""

    project: str
    pipeline: str
    steps: list[Step]
    dependencies: Dependencies = field(repr=False)
    output: Resource = WINDOW
    """The resource that the picture is read from."""

    @property
    def running(self) -> list[Step]:
        """The steps that run."""
        return [step for step in self.steps if step.run]

    @property
    def graph(self) -> Network:
        """The passes and resources as a new ``networkx.DiGraph``, which the caller may change.

        :mod:`nau_py.graph.network` documents its nodes, edges and attributes. The first call
        imports networkx, which takes a quarter of a second; making a plan does not.
        """
        from nau_py.graph.network import build_graph

        return build_graph(self.project, self.pipeline, self.steps, self.dependencies, self.output)

    def _repr_html_(self) -> str:
        """Draw the graph of passes and resources, for notebooks."""
        from nau_py.graph.picture import draw_svg

        return draw_svg(self.graph)


def _find_outputs(dependencies: Dependencies) -> list[Resource]:
    """List what the user sees: the window, or the resources of the last pass that writes."""
    if any(WINDOW in access.writes for access in dependencies.accesses):
        return [WINDOW]
    for pass_, access in zip(reversed(dependencies.passes), reversed(dependencies.accesses)):
        if access.writes and pass_.run_mode != "DONT_RUN":
            return list(access.writes)
    return []


def _has_side_effects(pass_: Pass) -> bool:
    return any((pass_.testScript, pass_.preScript, pass_.postScript))


def _find_needed(dependencies: Dependencies, wanted: set[Resource]) -> set[int]:
    """Find the indices of the passes that ``wanted`` needs, in this frame and the next one."""
    kept: set[int] = set()
    across_frames: set[Resource] = set()
    while True:
        live = wanted | across_frames
        found: set[int] = set()
        for index in range(len(dependencies.passes) - 1, -1, -1):
            pass_, access = dependencies.passes[index], dependencies.accesses[index]
            if pass_.run_mode == "DONT_RUN":
                continue
            if _has_side_effects(pass_) or live.intersection(access.writes):
                found.add(index)
                if pass_.run_mode == "RUN_ALWAYS":
                    live -= set(access.replaces)
                live |= set(access.reads)
        history = {resource for index, resource in dependencies.history if index in found}
        if found == kept and history <= across_frames:
            return found
        kept, across_frames = found, across_frames | history


def _explain_omission(dependencies: Dependencies, index: int, contracts: Contracts) -> str:
    pass_, access = dependencies.passes[index], dependencies.accesses[index]
    if pass_.pass_class not in contracts:
        return f"its class '{pass_.pass_class}' is not supported"
    if pass_.run_mode == "DONT_RUN":
        return "its mode is DONT_RUN"
    if not access.writes:
        return "it writes nothing"
    written = ", ".join(str(resource) for resource in access.writes)
    return f"nothing that the picture needs reads what it writes ({written})"


def make_plan(
    project: Project,
    pipeline: Pipeline,
    contracts: Contracts,
    wanted: frozenset[Resource] = frozenset(),
    everything: bool = False,
) -> Plan:
    """Plan ``pipeline``: decide which passes run.

    ``wanted`` names resources to keep beside the picture; ``everything`` keeps all that is
    written (for ``--targets``).
    """
    dependencies = find_dependencies(project, pipeline, contracts)
    outputs = _find_outputs(dependencies)
    live = set(outputs) | wanted
    if everything:
        live |= {resource for access in dependencies.accesses for resource in access.writes}
    kept = _find_needed(dependencies, live)
    steps = [
        Step(
            dependencies.passes[index],
            dependencies.accesses[index],
            index in kept,
            "" if index in kept else _explain_omission(dependencies, index, contracts),
        )
        for index in range(len(dependencies.passes))
    ]
    output = outputs[0] if outputs else WINDOW
    return Plan(project.name, pipeline.name or "", steps, dependencies, output)
