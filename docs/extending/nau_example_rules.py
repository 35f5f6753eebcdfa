"""A lint rule: names of cameras begin with a capital letter."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.plugin import WARNING, Change, Diagnostic, Fix, LintContext, Part, check, rule

Z001 = rule(
    "Z001",
    WARNING,
    "Camera without a capital letter",
    "The names of cameras are proper names.",
    "<camera name='eye'/>",
    "<camera name='Eye'/>",
)


@check
def capitals(context: LintContext) -> Iterator[Diagnostic]:
    for camera in context.project.assets.cameras:
        name = camera.name or ""
        if name[:1].islower():
            where, better = camera.where("name"), name[:1].upper() + name[1:]
            fix = Fix(f"Write '{better}'", (Change(where, Part.VALUE, name, better),))
            yield Z001.at(where, f"camera '{name}' begins with a small letter", fixes=(fix,))
