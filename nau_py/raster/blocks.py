"""Uniform blocks: one buffer per block name, shared by all programs (docs/format.md, 6.8)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nau_py.raster import gl
from nau_py.raster.gl import GL


@dataclass(slots=True)
class BlockMember:
    """A member of a block: byte offset and stride between matrix columns."""

    offset: int
    gl_type: int
    matrix_stride: int


@dataclass(slots=True)
class Block:
    """The storage of one block name."""

    point: int
    buffer: Any
    data: bytearray
    dirty: bool = True


class UniformBlocks:
    """Blocks by name. Binding points are numbered in the order of first use."""

    def __init__(self, ctx: Any) -> None:
        self._ctx = ctx
        self._blocks: dict[str, Block] = {}
        self._members: dict[int, dict[tuple[str, str], BlockMember]] = {}

    def attach(self, program: int) -> None:
        """Allocate storage for the blocks of a new program, and query their layout."""
        blocks = gl.active_blocks(program)
        for index, (name, size) in enumerate(blocks):
            block = self._blocks.get(name)
            if block is None:
                buffer = self._ctx.buffer(reserve=size)
                block = self._blocks[name] = Block(len(self._blocks), buffer, bytearray(size))
            elif size > len(block.data):
                block.data += bytes(size - len(block.data))
                block.buffer.orphan(size)
                block.dirty = True
            GL.glUniformBlockBinding(program, index, block.point)
        names = [name for name, _ in blocks]
        self._members[program] = {
            (names[block], member.split(".")[-1]): BlockMember(offset, kind, stride)
            for member, kind, offset, block, stride in gl.active_block_members(program)
        }

    def set(self, program: int, block: str, uniform: str, value: np.ndarray[Any, Any]) -> None:
        """Write a flat value into a member. Ignore a name that is not active, as Nau does."""
        member = self._members.get(program, {}).get((block, uniform.split(".")[-1]))
        if member is None:
            return
        storage = self._blocks[block]
        count = gl.count_components(member.gl_type)
        flat = np.zeros(count, gl.uniform_dtype(member.gl_type))
        given = value.reshape(-1)[:count]
        flat[: len(given)] = given
        rows = int(count**0.5) if member.matrix_stride else 1
        for row in range(rows):
            raw = flat.reshape(rows, -1)[row].tobytes()
            start = member.offset + row * member.matrix_stride
            if storage.data[start : start + len(raw)] != raw:
                storage.data[start : start + len(raw)] = raw
                storage.dirty = True

    def bind(self) -> None:
        """Upload the changed blocks and bind all of them."""
        for block in self._blocks.values():
            if block.dirty:
                block.buffer.write(bytes(block.data))
                block.dirty = False
            GL.glBindBufferBase(GL.GL_UNIFORM_BUFFER, block.point, block.buffer.glo)
