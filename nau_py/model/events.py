"""Sensors, interpolators and routes (docs/format.md, 3.8)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Items, Node
from nau_py.model.values import DataType


class SensorValue(Node):
    """A property of a sensor."""

    value: Annotated[float | None, Attr(DataType.FLOAT, "Number.", required=True)] = None


class SensorVector(Node):
    """A vector property of a sensor."""

    x: Annotated[float | None, Attr(DataType.FLOAT, "x.", required=True)] = None
    y: Annotated[float | None, Attr(DataType.FLOAT, "y.", required=True)] = None
    z: Annotated[float | None, Attr(DataType.FLOAT, "z.", required=True)] = None


class Sensor(Node):
    """A source of events: a clock, or a box that detects objects."""

    name: Annotated[str | None, Attr(doc="Sensor name.", required=True)] = None
    class_: Annotated[
        str | None,
        Attr(name="class", required=True, values=("TimeSensor", "ProximitySensor"), doc="Kind."),
    ] = None
    enabled: Annotated[SensorValue | None, Child(SensorValue)] = None
    loop: Annotated[SensorValue | None, Child(SensorValue)] = None
    secondsToStart: Annotated[SensorValue | None, Child(SensorValue)] = None
    cycleInterval: Annotated[SensorValue | None, Child(SensorValue)] = None
    center: Annotated[SensorVector | None, Child(SensorVector)] = None
    size: Annotated[SensorVector | None, Child(SensorVector)] = None


class KeyFrame(Node):
    """A value at a fraction of the interval."""

    key: Annotated[float | None, Attr(DataType.FLOAT, "Fraction 0..1.")] = None
    x: Annotated[float | None, Attr(DataType.FLOAT, "x.")] = None
    y: Annotated[float | None, Attr(DataType.FLOAT, "y.")] = None
    z: Annotated[float | None, Attr(DataType.FLOAT, "z.")] = None
    w: Annotated[float | None, Attr(DataType.FLOAT, "w.")] = None


class Interpolator(Node):
    """Linear interpolation between key frames."""

    name: Annotated[str | None, Attr(doc="Interpolator name.", required=True)] = None
    class_: Annotated[
        str | None, Attr(name="class", required=True, values=("PositionInterpolator",), doc="Kind.")
    ] = None
    keyFrames: Annotated[list[KeyFrame], Items(KeyFrame, "keyFrame", "keyFrames")] = Field(
        default_factory=list
    )


class Route(Node):
    """A connection that passes the events of a sender to a receiver."""

    name: Annotated[str | None, Attr(doc="Route name.", required=True)] = None
    sender: Annotated[str | None, Attr(doc="Sender.", required=True)] = None
    receiver: Annotated[str | None, Attr(doc="Receiver.", required=True)] = None
    eventIn: Annotated[str | None, Attr(doc="Event sent on.", required=True)] = None
    eventOut: Annotated[str | None, Attr(doc="Event waited for.", required=True)] = None
