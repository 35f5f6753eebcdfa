"""model.schema: one description of the fields of a node class."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

import pytest
from pydantic import Field

from nau_py.formats.bind import Binder, make_element
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.mask import MaskPass
from nau_py.model.node import Attr, Child, Choice, Items, Node, Variants
from nau_py.model.pass_classes import PASS_CLASSES
from nau_py.model.physics import PhysicsLibrary
from nau_py.model.pipeline import Pipeline
from nau_py.model.project import ProjectFile
from nau_py.model.scene import Primitive, Scene
from nau_py.model.schema import schema_of
from nau_py.model.values import DataType
from nau_py.passes import pass_classes
from nau_py.syntax.element import Element


class Leaf(Node):
    """A leaf."""

    size: Annotated[int | None, Attr(DataType.INT, "Size.", required=True, name="class")] = None


class Other(Node):
    """Another leaf."""


class Tree(Node):
    """A node with every kind of field."""

    name: Annotated[str | None, Attr(doc="Name.")] = None
    one: Annotated[Leaf | None, Child(Leaf, "first", "The first.")] = None
    plain: Annotated[list[Leaf], Items(Leaf, "leaf")] = Field(default_factory=list)
    wrapped: Annotated[list[Leaf], Items(Leaf, "leaf", "leaves")] = Field(default_factory=list)
    chosen: Annotated[
        list[Node],
        Items(Node, "any", "anything", choice=Choice("kind", "leaf", {"leaf": Leaf}, Other)),
    ] = Field(default_factory=list)
    mixed: Annotated[list[Any], Variants({"a": Leaf, "b": Other}, "both")] = Field(
        default_factory=list
    )


def known_classes() -> Iterator[type[Node]]:
    """Yield every class that a file can reach."""
    pass_classes()
    waiting: list[type[Node]] = [ProjectFile, MaterialLibrary, PhysicsLibrary]
    seen: set[type[Node]] = set()
    while waiting:
        cls = waiting.pop()
        if cls not in seen:
            seen.add(cls)
            yield cls
            waiting += [c for part in schema_of(cls).children for c in part.alternatives]


def test_attributes() -> None:
    (name,) = schema_of(Tree).attributes
    assert (name.name, name.field, name.doc, name.required) == ("name", "name", "Name.", False)
    (size,) = schema_of(Leaf).attributes
    assert (size.name, size.field, size.type, size.required) == ("class", "size", "INT", True)
    assert size.of(Leaf(size=3)) == 3
    assert size.of(Leaf()) is None


def test_children() -> None:
    schema = schema_of(Tree)
    outer = {tag: part.field for tag, part in schema.by_tag.items()}
    assert outer == {
        "first": "one",
        "leaf": "plain",
        "leaves": "wrapped",
        "anything": "chosen",
        "both": "mixed",
    }
    assert [part.field for part in schema.plain_lists] == ["plain"]
    assert schema.tags(Registry()) == list(outer)
    one, plain, _, chosen, mixed = schema.children
    assert (one.many, one.tag, one.cls, one.doc) == (False, "first", Leaf, "The first.")
    assert one.of(Tree()) == []
    leaf = Leaf(size=1)
    assert one.of(Tree(one=leaf)) == plain.of(Tree(plain=[leaf])) == [leaf]
    assert (chosen.class_of("any", {}), chosen.class_of("any", {"kind": "x"})) == (Leaf, Other)
    assert chosen.class_of("leaf", {}) is None
    assert (mixed.class_of("b", {}), mixed.tag_of(Other())) == (Other, "b")


def test_settings_follow_the_attribute_set_of_the_project() -> None:
    registry = Registry()
    schema = schema_of(Scene)
    (part,) = schema.settings
    assert (part.type, part.as_tags) == ("SCENE", True)
    assert schema.setting("MINE", registry) is None
    registry.add("SCENE", registry["CAMERA"].attributes["FOV"])
    found = schema.setting("FOV", registry)
    assert found is not None
    assert (found[0], found[1].type) == (part, "FLOAT")
    inline = schema_of(Primitive).inline_setting("SLICES", registry)
    assert inline is not None
    assert (inline[0].type, inline[0].as_tags) == ("SPHERE", False)


def test_the_class_of_a_pass_is_chosen_by_its_attribute() -> None:
    (part,) = schema_of(Pipeline).plain_lists
    pass_classes()
    assert part.class_of("pass", {"class": "mask"}) is MaskPass
    assert part.class_of("pass", {}) is PASS_CLASSES["default"]
    assert set(part.alternatives) == set(PASS_CLASSES.values())


def test_content_is_in_the_order_of_declaration() -> None:
    schema = schema_of(Scene)
    fields = schema.each_content(lambda part: part.field, lambda part: part.field)
    assert fields == [n for n in Scene.model_fields if n in set(fields)]


def test_a_tag_is_declared_once() -> None:
    class Twice(Node):
        """Two fields of one tag."""

        a: Annotated[Leaf | None, Child(Leaf, "leaf")] = None
        b: Annotated[list[Leaf], Items(Leaf, "leaf")] = Field(default_factory=list)

    with pytest.raises(TypeError, match="Twice declares the child <leaf> twice"):
        schema_of(Twice)


@pytest.mark.parametrize("cls", list(known_classes()), ids=lambda cls: cls.__name__)
def test_every_class_is_described_and_documented(cls: type[Node]) -> None:
    schema = schema_of(cls)
    assert schema.doc.endswith(".")
    assert all(attribute.doc.endswith(".") for attribute in schema.attributes)
    # an empty element is bound and written back
    registry = Registry()
    node = Binder(registry, []).bind(Element("x"), cls)
    assert make_element(node, "x", registry) == Element("x")
