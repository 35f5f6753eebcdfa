"""The tokeniser: no character is lost, and half-written text is split as far as it goes."""

from __future__ import annotations

from pathlib import Path

import pytest

from nau_py.syntax.xml_tokens import Token, TokenKind, tokenise
from tests.conftest import ROOT

FILES = sorted(
    path for folder in ("projects", "materials") for path in (ROOT / folder).rglob("*.[xm][ml]*")
)


def split(text: str) -> list[str]:
    return [f"{t.kind.name} {t.text}" for t in tokenise(text) if t.kind is not TokenKind.SPACE]


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_tokens_joined_are_the_text(path: Path) -> None:
    whole = path.read_text()
    for text in (whole, *(whole[: len(whole) * part // 17] for part in range(17))):
        tokens = list(tokenise(text))
        assert "".join(t.text for t in tokens) == text
        ends = [0, *(t.end for t in tokens)]
        assert [t.offset for t in tokens] == ends[:-1]


@pytest.mark.parametrize(
    "text, tokens",
    [
        ("\ufeff<a/>", ["MARK \ufeff", "START <a", "CLOSE_EMPTY />"]),
        ("<a x = 1>b</a >", "START <a|NAME x|EQUALS =|VALUE 1|CLOSE >|TEXT b|END </a|CLOSE >"),
        ("<a x='>' y=\"'\"/>", "START <a|NAME x|EQUALS =|VALUE '>'|NAME y|EQUALS =|VALUE \"'\"|CLOSE_EMPTY />"),
        ("<!-- <a> --><?b?>", "COMMENT <!-- <a> -->|DECLARATION <?b?>"),
        ("<a x=<b/>", "START <a|NAME x|EQUALS =|VALUE <b|CLOSE_EMPTY />"),
        ("<a x <b y='1'>", "START <a|NAME x|START <b|NAME y|EQUALS =|VALUE '1'|CLOSE >"),
        ("<a></b <c>", "START <a|CLOSE >|END </b|START <c|CLOSE >"),
        ("<a '>' 5/ >", "START <a|JUNK '>'|NAME 5|JUNK /|CLOSE >"),
        ("<a x='1", "START <a|NAME x|EQUALS =|VALUE '1"),
        ("< </", "START <|END </"),
        ("<!-- a", "COMMENT <!-- a"),
    ],
)  # fmt: skip
def test_kinds(text: str, tokens: str | list[str]) -> None:
    assert split(text) == (tokens.split("|") if isinstance(tokens, str) else tokens)


@pytest.mark.parametrize(
    "text, quote, closed, span, value",
    [
        ("'a&lt;b'", "'", True, (1, 7), "a<b"),
        ("a&amp;b", "", True, (0, 7), "a&b"),
        ('"', '"', False, (1, 1), ""),
        ('"a', '"', False, (1, 2), "a"),
        ("''", "'", True, (1, 1), ""),
    ],
)
def test_values(text: str, quote: str, closed: bool, span: tuple[int, int], value: str) -> None:
    token = Token(TokenKind.VALUE, text, 0)
    assert (token.quote, token.closed, token.span, token.value) == (quote, closed, span, value)
