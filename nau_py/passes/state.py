"""State that passes keep from frame to frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol, TypeVar, cast


class PassState(Protocol):
    """State that one pass keeps from frame to frame in a session."""

    def reload_shaders(self, files: set[Path]) -> None:
        """Replace the GLSL programs whose source files (resolved paths) have changed."""
        ...

    def reload_programs(self) -> None:
        """Load the ray programs again. Raises :class:`~nau_py.ProgramError`; the programs loaded
        before then stay in use."""
        ...

    def close(self) -> None:
        """Free the resources of this state, which is not used again."""
        ...


S = TypeVar("S", bound=PassState)


class PassStates:
    """The states of a session's passes, by pass name."""

    def __init__(self) -> None:
        self._states: dict[str, tuple[object, PassState]] = {}

    def get(self, name: str, key: object, make: Callable[[], S]) -> S:
        """Return the state of pass ``name``; make it first where there is none of this ``key``.

        ``key``: identifies the factory, so that the same key always returns the same type. A state
        of another key is closed and replaced.
        """
        found = self._states.get(name)
        if found is not None and found[0] == key:
            return cast(S, found[1])
        if found is not None:
            del self._states[name]
            found[1].close()
        state = make()
        self._states[name] = key, state
        return state

    def __getitem__(self, name: str) -> PassState:
        return self._states[name][1]

    def __iter__(self) -> Iterator[PassState]:
        return (state for _, state in self._states.values())

    def close(self) -> None:
        """Close and forget every state."""
        states = list(self)
        self._states.clear()
        for state in states:
            state.close()


class Stateless:
    """State of a pass that keeps nothing."""

    def reload_shaders(self, files: set[Path]) -> None:
        """Do nothing."""

    def reload_programs(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""
