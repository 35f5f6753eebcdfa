"""The plan of a pipeline: which passes run, in which order, and why the others do not."""

from __future__ import annotations

from dataclasses import dataclass, field

from nau_py.graph.contract import Access, Contracts
from nau_py.graph.dependencies import PassGraph, build
from nau_py.graph.resource import WINDOW, Resource
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline


@dataclass(frozen=True, slots=True)
class Step:
    """One pass of the plan. ``reason`` says why it is left out, and is empty where it runs."""

    pass_: Pass
    access: Access
    run: bool
    reason: str = ""

    @property
    def name(self) -> str:
        return self.pass_.name or ""


@dataclass(slots=True)
class Plan:
    """What running a pipeline means. A pure value: making it needs no GL context."""

    project: str
    pipeline: str
    steps: list[Step]
    graph: PassGraph = field(repr=False)
    output: Resource = WINDOW
    """What the picture is read from."""

    def _repr_html_(self) -> str:
        """The graph of passes and targets, for notebooks."""
        from nau_py.graph.export import to_svg

        return to_svg(self)

    @property
    def running(self) -> list[Step]:
        return [step for step in self.steps if step.run]


def _outputs(graph: PassGraph) -> list[Resource]:
    """What the user sees: the window, or what the last writing pass writes."""
    if any(WINDOW in access.writes for access in graph.accesses):
        return [WINDOW]
    for pass_, access in zip(reversed(graph.passes), reversed(graph.accesses)):
        if access.writes and pass_.run_mode != "DONT_RUN":
            return list(access.writes)
    return []


def _has_side_effects(pass_: Pass) -> bool:
    return any((pass_.testScript, pass_.preScript, pass_.postScript))


def _keep(graph: PassGraph, wanted: set[Resource]) -> set[int]:
    """Indices of the passes that ``wanted`` needs, this frame's and the next one's."""
    kept: set[int] = set()
    across_frames: set[Resource] = set()
    while True:
        live = wanted | across_frames
        found: set[int] = set()
        for index in range(len(graph.passes) - 1, -1, -1):
            pass_, access = graph.passes[index], graph.accesses[index]
            if pass_.run_mode == "DONT_RUN":
                continue
            if _has_side_effects(pass_) or live.intersection(access.writes):
                found.add(index)
                if pass_.run_mode == "RUN_ALWAYS":
                    live -= set(access.replaces)
                live |= set(access.reads)
        history = {resource for index, resource in graph.history if index in found}
        if found == kept and history <= across_frames:
            return found
        kept, across_frames = found, across_frames | history


def _reason(graph: PassGraph, index: int, contracts: Contracts) -> str:
    pass_, access = graph.passes[index], graph.accesses[index]
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
    """Plan ``pipeline``.

    ``wanted`` names resources to keep beside the picture; ``everything`` keeps all that is
    written (for ``--targets``).
    """
    graph = build(project, pipeline, contracts)
    outputs = _outputs(graph)
    live = set(outputs) | wanted
    if everything:
        live |= {resource for access in graph.accesses for resource in access.writes}
    kept = _keep(graph, live)
    steps = [
        Step(
            graph.passes[index],
            graph.accesses[index],
            index in kept,
            "" if index in kept else _reason(graph, index, contracts),
        )
        for index in range(len(graph.passes))
    ]
    output = outputs[0] if outputs else WINDOW
    return Plan(project.name, pipeline.name or "", steps, graph, output)
