"""X: text that readers could not use, and old dialects."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Change, Diagnostic, Fix, Part
from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.rules.registry import LintContext, check

X001 = rule(
    "X001",
    ERROR,
    "File cannot be read",
    "The project file or a library could not be opened.",
    "nau-lint missing.xml",
    "nau-lint project.xml",
)
X002 = rule(
    "X002",
    ERROR,
    "Broken XML",
    "Nau's XML dialect allows unquoted values and more, but tags must close and match.",
    "<scene name='A'></scenes>",
    "<scene name='A'></scene>",
)
X003 = rule(
    "X003",
    WARNING,
    "Text between elements",
    "Text outside tags is ignored; often it is a comment without its marks.",
    "<map> old <state/></map>",
    "<map> <!-- old --> <state/></map>",
)
X004 = rule(
    "X004",
    WARNING,
    "Section or value given twice",
    "Of a section only the first one counts, of a value only the last.",
    "<lights/> … <lights><light name='Sun'/></lights>",
    "<lights><light name='Sun'/></lights>",
)
X005 = rule(
    "X005",
    NOTE,
    "Old dialect",
    "The element has an old spelling, which today's Nau rejects. It is read with its present "
    "meaning.",
    "<attribute name='n' context='PASS' type='INT'/>",
    "<attribute name='n' type='PASS' data='INT'/>",
)
V001 = rule(
    "V001",
    ERROR,
    "Wrong type",
    "The text is not a value of the expected type.",
    "<FOV value='wide'/>",
    "<FOV value='60'/>",
)
V002 = rule(
    "V002",
    WARNING,
    "Text after a number",
    "Only the beginning of the text is used, as Nau does.",
    "<POSITION x='1' y='102.55.0' z='3'/>",
    "<POSITION x='1' y='102.55' z='3'/>",
)
V003 = rule(
    "V003",
    ERROR,
    "Value is incomplete",
    "A component of a vector is missing.",
    "<POSITION x='1' y='2'/>",
    "<POSITION x='1' y='2' z='3'/>",
)
V004 = rule(
    "V004",
    ERROR,
    "Read-only attribute",
    "The attribute is computed; a file cannot set it.",
    "<NORMALIZED_VIEW x='0' y='0' z='1'/>",
    "<VIEW x='0' y='0' z='1'/>",
)

_TYPES = {"INT": "an integer", "UINT": "an integer", "FLOAT": "a number", "BOOL": "true or false"}


def _place(problem: Problem) -> str:
    inside = f"<{problem.element}>" if problem.element else "the file"
    return f"attribute '{problem.attribute}' of {inside}" if problem.attribute else inside


def _diagnostic(p: Problem) -> Diagnostic:
    if p.kind is ProblemKind.UNREADABLE:
        return X001.at(p.location, f"'{p.value}' cannot be read: {p.detail}")
    if p.kind is ProblemKind.SYNTAX:
        return X002.at(p.location, p.detail)
    if p.kind is ProblemKind.STRAY_TEXT:
        return X003.at(p.location, f"text between elements is ignored: '{p.value}'")
    if p.kind is ProblemKind.REPEATED:
        return X004.at(p.location, f"<{p.element}> is given a second time in <{p.detail}>")
    if p.kind is ProblemKind.LEGACY:
        return X005.at(p.location, f"<{p.element}> is an old spelling: {p.detail}")
    if p.kind is ProblemKind.UNCONVERTIBLE:
        expected = _TYPES.get(p.expected, f"a number ({p.expected})")
        return V001.at(p.location, f"{_place(p)} is '{p.value}'; {expected} is expected")
    if p.kind is ProblemKind.TRAILING_TEXT:
        fix = Fix(
            f"Write {p.expected}", (Change(p.location, Part.VALUE, p.value, p.expected),), True
        )
        message = f"{_place(p)} is '{p.value}' and is read as {p.expected}"
        return V002.at(p.location, message, fixes=(fix,))
    if p.kind is ProblemKind.INCOMPLETE:
        return V003.at(p.location, f"<{p.element}> is a {p.detail} and lacks '{p.expected}'")
    return V004.at(p.location, f"<{p.element}> is read-only; a file cannot set it")


@check
def check_problems(context: LintContext) -> Iterator[Diagnostic]:
    """Report every problem of the readers."""
    yield from (_diagnostic(p) for p in context.project.problems)
