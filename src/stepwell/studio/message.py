"""The messages between page and server: JSON in, a header of JSON and arrays out.

A message of the page is text: {"v": 1, "type": T, "seq": n, "design": D, "ask": {...}}, and
"leg": k where D is a robot and the question is about the chain of one of its legs. An answer is
binary: the length of the header as a little-endian u32, the header as JSON in UTF-8, zeros up
to a multiple of 8, then the arrays that the header lists, each filled up to a multiple of 8.
"""

import json
import math
import re
import struct
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, StepwellError, nearest_word, printable
from stepwell.files import DesignError, slips_text
from stepwell.mechanism import SlipError
from stepwell.studio.ask import View

# A key path at the start of a message, and the text after it.
_NAME = r'(?:[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*")'
_AT = re.compile(rf"(?P<at>[A-Za-z_][A-Za-z0-9_-]*(?:\[\d+\]|\.{_NAME})*)(?: = |: |, )")


class Refusal(NamedTuple):
    """One problem; `at` is the key path, "" where the sentence names none."""

    at: str
    text: str

    @classmethod
    def of(cls, text: str) -> "Refusal":
        """The problem in a sentence."""
        match = _AT.match(text)
        return cls(match["at"] if match else "", text)


def problems_of(error: StepwellError) -> list[Refusal]:
    """All problems of an error, with the text that a command prints."""
    if isinstance(error, DesignError):
        return [Refusal.of(line) for line in error.problems]
    return [Refusal.of(slips_text(error) if isinstance(error, SlipError) else str(error))]


VERSION = 1
LONGEST_MESSAGE = 1 << 20  # bytes
_KEYS = ("v", "type", "seq", "design", "leg", "ask")
_MOST = 2**53 - 1  # largest exact integer in JavaScript
_STEPS = 2**16 - 1  # largest number of u2
_DTYPES = {"f": ("f8", "<f8"), "i": ("i4", "<i4"), "u": ("i4", "<i4"), "b": ("i4", "<i4")}


class WireError(InputError):
    """A message that cannot be parsed; `seq` is its number, or 0."""

    def __init__(self, text: str, seq: int = 0):
        self.seq = seq
        super().__init__(text)


class Message(NamedTuple):
    """A request of the page; `studies` is the folder of the server, never set by the page."""

    type: str
    seq: int
    design: dict[str, Any] | None = None
    ask: Mapping[str, Any] = MappingProxyType({})
    leg: int = 0
    studies: Path | None = None


def message_of(text: str, types: Iterable[str]) -> Message:
    """The request in a text; a WireError if it is not a request of a known type."""
    keys = _parsed_object(text)
    seq: Any = keys.get("seq")
    for problem in _problems(keys, [*types]):
        raise WireError(problem, seq if _is_number(seq) else 0)
    ask, leg = keys.get("ask") or {}, keys.get("leg", 0)
    return Message(keys["type"], seq, keys.get("design"), ask, leg)


def _parsed_object(text: str) -> dict[str, Any]:
    try:
        value: Any = json.loads(text)
    except RecursionError:
        raise WireError("the message is nested too deeply.") from None
    except ValueError as error:
        raise WireError(f"the message is not JSON: {printable(str(error))[:120]}.") from None
    if not isinstance(value, dict):
        raise WireError("the message must be an object with v, type and seq.")
    return value


def _problems(keys: Mapping[str, Any], types: list[str]) -> Iterator[str]:
    """Problems of the keys of a message."""
    for key in keys:
        if key not in _KEYS:
            yield f"{_shortened(key)}: unknown key; known are {', '.join(_KEYS)}."
    seq, version, kind, leg = (keys.get(key) for key in ("seq", "v", "type", "leg"))
    if not _is_number(seq):
        yield f"seq = {_shortened(seq)}: must be a whole number from 0 to 2^53 - 1."
    if type(version) is not int or version != VERSION:
        yield f"v = {_shortened(version)}: must be {VERSION}; load the page again."
    if kind not in types:
        near = nearest_word(kind, types) if isinstance(kind, str) else None
        advice = f"Did you mean {near}?" if near else f"Known here: {', '.join(types)}."
        yield f"type = {_shortened(kind)}: no such type. {advice}"
    for key in ("design", "ask"):
        if not isinstance(keys.get(key), dict | None):
            yield f"{key} = {_shortened(keys[key])}: must be an object."
    if "leg" in keys and not _is_number(leg, math.inf):
        yield f"leg = {_shortened(leg)}: must be a whole number from 0."


def _is_number(value: Any, most: float = _MOST) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= most


def packed(kind: str, seq: int, view: View) -> bytes:
    """The answer of a panel as bytes."""
    arrays = {name: _stored_block(block) for name, block in view.blocks.items()}
    listed = [
        {"name": name, "dtype": dtype, "shape": list(block.shape)}
        for name, (dtype, block) in arrays.items()
    ]
    pieces = [_header_bytes({**_header(kind, seq), "ok": True, **view.header, "blocks": listed})]
    for _, block in arrays.values():
        data = block.tobytes()
        pieces += [data, bytes(-len(data) % 8)]
    return b"".join(pieces)


def refusal_message(kind: str, seq: int, problems: Iterable[Refusal], **more: Any) -> bytes:
    """A refusal as bytes, with all problems."""
    listed = [problem._asdict() for problem in problems]
    return _header_bytes(
        {**_header(kind, seq), "ok": False, **more, "problems": listed, "blocks": []}
    )


def parse_failure(error: WireError) -> bytes:
    """The answer to a message that cannot be parsed."""
    return refusal_message("error", error.seq, [Refusal("", str(error))])


def partial_answer(kind: str, seq: int, view: View) -> bytes:
    """A partial answer as bytes."""
    return packed(kind, seq, View({**view.header, "part": True}, view.blocks))


def progress_message(kind: str, seq: int, done: float, total: float) -> bytes:
    """The progress of a long computation as bytes."""
    return _header_bytes(
        {**_header(kind, seq), "ok": True, "progress": [done, total], "blocks": []}
    )


def in_steps(table: Floats) -> tuple[np.ndarray[Any, Any], list[list[float]]]:
    """A table of finite numbers as u2, a quarter of its bytes, and its entry in `steps`."""
    first, step = table.min(axis=0), np.ptp(table, axis=0) / _STEPS
    steps = np.rint((table - first) / np.where(step > 0.0, step, 1.0))
    return steps.astype(np.uint16), [first.tolist(), step.tolist()]


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    """Header and arrays of an answer, as the page reads them."""
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + length])
    at = 4 + length + -(4 + length) % 8
    blocks: dict[str, np.ndarray[Any, Any]] = {}
    for block in header["blocks"]:
        count = int(np.prod(block["shape"]))
        array = np.frombuffer(data, f"<{block['dtype']}", count, at)
        at += array.nbytes + -array.nbytes % 8
        blocks[block["name"]] = array.reshape(block["shape"])
        if block["dtype"] == "u2":
            first, step = np.array(header["steps"][block["name"]])
            blocks[block["name"]] = first + step * blocks[block["name"]]
    return header, blocks


def _header(kind: str, seq: int) -> dict[str, Any]:
    return {"v": VERSION, "type": kind, "seq": seq}


def _header_bytes(header: Mapping[str, Any]) -> bytes:
    text = json.dumps(header, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    return struct.pack("<I", len(text)) + text + bytes(-(4 + len(text)) % 8)


def _stored_block(block: np.ndarray[Any, Any]) -> tuple[str, np.ndarray[Any, Any]]:
    if block.dtype == np.uint8:  # a file
        return "u1", np.ascontiguousarray(block)
    # What is drawn and not printed.
    for kind, dtype in (np.float32, "f4"), (np.uint16, "u2"):
        if block.dtype == kind:
            return dtype, np.ascontiguousarray(block, f"<{dtype}")
    dtype, stored = _DTYPES[block.dtype.kind]
    return dtype, np.ascontiguousarray(block, stored)


def _shortened(value: Any) -> str:
    text = ascii(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
