"""A design as Python that makes it."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass
from typing import Any

from stepwell.mechanism import Chain
from stepwell.robot import Robot

_LONGEST = 88


def script(design: Chain | Robot, toml: str) -> str:
    """Python that makes the design, equal to the last bit, and says what it does.

    Args:
        design: any.
        toml: its design file, for robots and for chains with elements: they are read from it, not
            spelled out.
    """
    if isinstance(design, Robot):
        made = f"from stepwell.files import loads\n\nrobot = loads({_block(toml)}).robot"
        return f"{made}\nprint(robot.predict())\n"
    if design.elements:
        made = f"from stepwell.files import loads\n\nchain = loads({_block(toml)}).chain"
    else:
        made = f"import stepwell as sw\n\nchain = {_made(design, 0)}"
    imports = "from math import inf\n\n" if "=inf" in made else ""
    return f"{imports}{made}\nprint(chain.cycle())\n"


def _block(text: str) -> str:
    """Text over several lines, as Python writes it."""
    if "'''" in text or "\\" in text:
        return repr(text)
    return f"'''\n{text}'''"


def _made(value: Any, depth: int) -> str:
    """A value of the public ones as the call that makes it."""
    if isinstance(value, tuple) and value and is_dataclass(value[0]):
        inner = [_made(one, depth + 1) for one in value]
        return _call("(", inner, ",)" if len(value) == 1 else ")", depth)
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    given = [
        (field.name, getattr(value, field.name))
        for field in fields(value)
        if field.init
        and not field.name.startswith("_")
        and (field.default is MISSING or getattr(value, field.name) != field.default)
        and not (field.default_factory is not MISSING)
    ]
    parts = [f"{name}={_made(own, depth + 1)}" for name, own in given]
    return _call(f"sw.{type(value).__name__}(", parts, ")", depth)


def _call(start: str, parts: list[str], end: str, depth: int) -> str:
    line = f"{start}{', '.join(parts)}{end}"
    if len(line) + 4 * depth <= _LONGEST and "\n" not in line:
        return line
    pad = "    " * (depth + 1)
    end = end.lstrip(",")
    return f"{start}\n" + "".join(f"{pad}{part},\n" for part in parts) + "    " * depth + end
