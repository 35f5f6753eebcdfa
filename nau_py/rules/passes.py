"""P: what passes need."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic, guess, listing, nearest
from nau_py.model.linked import Project
from nau_py.model.mask import MaskPass, PropertySelector
from nau_py.model.pass_classes import PASS_CLASSES, PLUGIN_CLASSES, ComputePass
from nau_py.model.target import CubeMapAttachment, RenderTarget
from nau_py.rules.registry import LintContext, check

MASK_FORMATS = ["RGBA32F", "RGBA16F"]

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
    "Nau or one of its plug-ins has the class, this version of nau_py does not. A pipeline with "
    "such a pass does not run; the others do.",
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
    "Kinds of texture do not go together",
    "Of the colour textures of a target all are cube maps, with one sample, or none is.",
    "<colors><color .../><cubemap .../></colors>",
    "<colors><cubemap .../><cubemap .../></colors>",
)


@check
def classes(context: LintContext) -> Iterator[Diagnostic]:
    """Pass classes that do not exist, or not here."""
    for pipeline in context.project.pipelines:
        for pass_ in pipeline.passes:
            name = pass_.pass_class
            if name in context.contracts:
                continue
            known = list(context.contracts)
            if name in PASS_CLASSES or name in PLUGIN_CLASSES:
                yield P002.at(
                    pass_.where("class"),
                    f"pass '{pass_.name}': class '{name}' is not supported by this version; "
                    f"supported are {listing(known)}",
                )
            else:
                yield P001.at(
                    pass_.where("class"),
                    f"pass '{pass_.name}': class '{name}' is unknown; there is "
                    f"{listing(known)}{nearest(name, known)}",
                    fixes=guess(pass_.where("class"), name, known),
                )


@check
def needs(context: LintContext) -> Iterator[Diagnostic]:
    """What compute and depthmap passes cannot do without."""
    for pipeline in context.project.pipelines:
        for pass_ in pipeline.passes:
            if isinstance(pass_, ComputePass):
                yield from _compute(pass_)
            elif pass_.pass_class == "depthmap":
                if not pass_.lights:
                    yield P003.at(pass_.location, f"depthmap pass '{pass_.name}' needs a <light>")
                if pass_.renderTarget is None:
                    yield P003.at(
                        pass_.location, f"depthmap pass '{pass_.name}' needs a <renderTarget>"
                    )
            elif isinstance(pass_, MaskPass):
                yield from _mask(context.project, pass_)


def _mask(project: Project, pass_: MaskPass) -> Iterator[Diagnostic]:
    owned = project.target_of(pass_)
    colors = owned[1].colors if owned else []
    if not colors:
        yield P003.at(
            pass_.location, f"mask pass '{pass_.name}' needs a <renderTarget> with a colour texture"
        )
    elif (colors[0].internalFormat or "RGBA") not in MASK_FORMATS:
        yield P003.at(
            colors[0].where("internalFormat"),
            f"mask pass '{pass_.name}' writes positions to '{colors[0].name}', of format "
            f"'{colors[0].internalFormat or 'RGBA'}'; {listing(MASK_FORMATS)} holds them",
        )
    known = [a.name for a in project.registry["COLOR"]]
    for top in pass_.select:
        for node in top.walk():
            if isinstance(node, PropertySelector) and node.name and node.name not in known:
                yield P003.at(
                    node.where("name"),
                    f"mask pass '{pass_.name}': materials have no '{node.name}'; there is "
                    f"{listing(known)}{nearest(node.name, known)}",
                    fixes=guess(node.where("name"), node.name, known),
                )


def _compute(pass_: ComputePass) -> Iterator[Diagnostic]:
    material = pass_.material
    if material is None:
        yield P003.at(pass_.location, f"compute pass '{pass_.name}' needs a <material>")
        return
    for axis in "XYZ":
        given, source = getattr(material, f"dim{axis}"), getattr(material, f"buffer{axis}")
        offset = getattr(material, f"offset{axis}")
        label = f"compute pass '{pass_.name}'"
        if given is not None and source is not None:
            message = f"{label}: 'dim{axis}' and 'buffer{axis}' exclude each other"
            yield P003.at(material.where(f"buffer{axis}"), message)
        if source is not None and offset is None:
            message = f"{label}: 'buffer{axis}' needs 'offset{axis}'"
            yield P003.at(material.where(f"buffer{axis}"), message)
        unset = given is None and source is None and f"dim{axis}" not in material.unknown_attributes
        if axis == "X" and unset and f"DIM_{axis}" not in pass_.settings:
            yield P003.at(material.location, f"{label}: <material> needs 'dimX' or 'bufferX'")


def target_size(project: Project, target: RenderTarget) -> tuple[int, int]:
    """Width and height that the file gives to a render target."""
    width, height = project.value(target, "RENDER_TARGET", "SIZE")
    return int(width), int(height)


def _kinds(project: Project, target: RenderTarget) -> Iterator[Diagnostic]:
    cubes = [c for c in target.colors if isinstance(c, CubeMapAttachment)]
    if cubes and len(cubes) < len(target.colors):
        yield P006.at(
            cubes[0].location,
            f"render target '{target.name}': cube map '{cubes[0].name}' stands beside textures "
            "that are none",
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
    """Render targets that cannot be made."""
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
