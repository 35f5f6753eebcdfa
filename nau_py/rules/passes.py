"""P: pass classes, their parameters, and render targets."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.model.attributes import PARAMETERS
from nau_py.model.linked import Project
from nau_py.model.pass_classes import PASS_CLASSES
from nau_py.model.passes import Pass
from nau_py.model.target import CubeMapAttachment, RenderTarget
from nau_py.rules.registry import LintContext, check

P001 = rule(
    "P001",
    ERROR,
    "Unknown pass class",
    "No pass class has that name.",
    "<pass name='a' class='quads'>",
    "<pass name='a' class='quad'>",
)
P002 = rule(
    "P002",
    WARNING,
    "Pass class not supported",
    "Nau has the class, this version of nau_py does not. A pipeline with such a pass does not run; "
    "other pipelines do.",
    "<pass name='a' class='mesh'>",
    "<pass name='a' class='default'>",
)
P003 = rule(
    "P003",
    ERROR,
    "Pass lacks what its class needs",
    "A compute pass needs a material and its work groups, a depth map a light and a target.",
    "<pass name='a' class='compute'/>",
    "<pass name='a' class='compute'><material name='m' fromLibrary='L' dimX='8'/></pass>",
)
P004 = rule(
    "P004",
    ERROR,
    "Render target without pixels",
    "SIZE is required; both numbers must be above 0.",
    "<renderTarget name='r'/>",
    "<renderTarget name='r'><SIZE width='512' height='512'/>",
)
P005 = rule(
    "P005",
    WARNING,
    "Attachment of more than 8 colours",
    "OpenGL promises only eight colour targets.",
    "nine <color/> elements",
    "up to eight",
)


P006 = rule(
    "P006",
    ERROR,
    "Cube maps beside other textures",
    "The colour textures of a target are all cube maps, with one sample, or none of them is.",
    "<colors><color .../><cubemap .../></colors>",
    "<colors><cubemap .../><cubemap .../></colors>",
)


P007 = rule(
    "P007",
    ERROR,
    "Parameter of another pass class",
    "Passes of this class do not have the parameter: it would have no effect.",
    "<pass name='a' class='default'><TARGET_ERROR value='0.1'/></pass>",
    "<pass name='a' class='raytrace'><TARGET_ERROR value='0.1'/></pass>",
)


@check
def check_pass_classes(context: LintContext) -> Iterator[Diagnostic]:
    """Find pass classes that do not exist, or not in this version."""
    known = list(context.contracts)
    for pass_ in _passes(context.project):
        name = pass_.pass_class
        if name in context.contracts:
            continue
        if name in PASS_CLASSES:
            yield P002.at(
                pass_.where("class"),
                f"pass '{pass_.name}': class '{name}' is not supported by this version; "
                f"supported are {format_names(known)}",
            )
        else:
            yield P001.at(
                pass_.where("class"),
                f"pass '{pass_.name}': class '{name}' is unknown; there is "
                f"{format_names(known)}{suggest_name(name, known)}",
                fixes=suggest_fix(pass_.where("class"), name, known),
            )


@check
def check_pass_faults(context: LintContext) -> Iterator[Diagnostic]:
    """Find the faults that the pass classes themselves report."""
    for pass_ in _passes(context.project):
        contract = context.contracts.get(pass_.pass_class)
        if contract is not None and isinstance(pass_, PASS_CLASSES.get(pass_.pass_class, Pass)):
            yield from contract.faults(context.project, pass_)


@check
def check_parameters(context: LintContext) -> Iterator[Diagnostic]:
    """Find parameters that passes of another class have."""
    registry = context.project.registry
    for pass_ in _passes(context.project):
        if pass_.pass_class not in PASS_CLASSES:
            continue  # P001
        own = registry.of(type(pass_), "PASS")
        for tag, elements in pass_.unknown_children.items():
            if tag in own or tag not in registry["PASS"]:
                continue  # unreadable, or an element that is no parameter: V001, S001
            owners = [n for n, m in PASS_CLASSES.items() if tag in registry.of(m, "PASS")]
            names = [p.name for p in PARAMETERS.get(type(pass_), ())]
            has = f"has {format_names(names)}" if names else "has no parameters of its own"
            message = (
                f"pass '{pass_.name}': {tag} is a parameter of class {format_names(owners)}; class "
                f"'{pass_.pass_class}' {has}{suggest_name(tag, own.writable)}"
            )
            for element in elements:
                yield P007.at(element.location, message)


def _passes(project: Project) -> Iterator[Pass]:
    for pipeline in project.pipelines:
        yield from pipeline.passes


def target_size(project: Project, target: RenderTarget) -> tuple[int, int]:
    """Return the width and height that the file gives to a render target."""
    width, height = project.value(target, "RENDER_TARGET", "SIZE")
    return int(width), int(height)


def _kinds(project: Project, target: RenderTarget) -> Iterator[Diagnostic]:
    cubes = [c for c in target.colors if isinstance(c, CubeMapAttachment)]
    if cubes and len(cubes) < len(target.colors):
        yield P006.at(
            cubes[0].location,
            f"render target '{target.name}': cube map '{cubes[0].name}' is mixed with "
            "textures that are not cube maps",
        )
    samples = int(project.value(target, "RENDER_TARGET", "SAMPLES")[0])
    if cubes and samples > 1:
        yield P006.at(
            target.settings["SAMPLES"].location,
            f"render target '{target.name}': SAMPLES is {samples}, but cube map "
            f"'{cubes[0].name}' has one sample",
        )


@check
def targets(context: LintContext) -> Iterator[Diagnostic]:
    """Find render targets that cannot be made."""
    for library in context.project.libraries[1:]:
        for target in library.renderTargets:
            width, height = target_size(context.project, target)
            if width < 1 or height < 1:
                yield P004.at(
                    target.location,
                    f"render target '{target.name}': SIZE is {width} x {height}; "
                    "both must be above 0",
                )
            yield from _kinds(context.project, target)
            if len(target.colors) > 8:
                yield P005.at(
                    target.location,
                    f"render target '{target.name}' has {len(target.colors)} colour targets",
                )
