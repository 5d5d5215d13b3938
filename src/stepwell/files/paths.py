"""Key paths: names of the numbers in a design file.

    foot.link_mm                            a key of a table
    leg.left.at_mm[0]                       the first number of a list
    leg.left.chain.cell.inner.q_mm[0]       a leg, a cell, an antenna by its name ...
    leg[0].chain.cell[0].q_mm[0]            ... or by its number from 0
    leg.*.chain.cell.*.friction_N           all of them
    chain.cell.inner                        chain in front is short for leg.*.chain
    chain.band.stiffness_N_per_m            what cells share, short for leg.*.chain.cell.*.band
    leg."hind left"                         other characters than letters, digits, - and _

A path that ends early selects all numbers below it.
"""

import json
import re
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from types import EllipsisType

from stepwell.base import InputError, nearest_word


@dataclass(frozen=True)
class Item:
    """An item of a list: its index from 0, and its name if it is unique."""

    index: int
    name: str | None = None


Steps = tuple[str | Item, ...]

ALL = ...  # every item of a list
Token = str | int | EllipsisType

_TOKEN = re.compile(
    r"""
    (?: \.? (?: (?P<all>\*) | "(?P<quoted>(?:[^"\\]|\\.)*)" | (?P<key>[^][."*\s]+) ) )
    | \[ (?: (?P<index>\d{1,6}) | (?P<each>\*) ) \]
    """,
    re.X,
)
_NO_PATH = (
    "is no key path; one looks like foot.link_mm, leg.left.at_mm[0] or chain.cell.inner.q_mm[0]."
)
# Keys that are common to all cells of a chain.
_OF_EVERY_CELL = ("lever_mm", "limit_deg", "band")


def spelled(steps: Iterable[str | Item]) -> str:
    """Key path of a number, as in `parameters`."""
    return _shown(map(_token, steps))


def find(path: str, known: Iterable[Steps], of: str = "robot") -> list[tuple[Steps, Steps]]:
    """Known numbers that a path selects, each with its steps below the path.

    ValueError if it selects none; the message suggests a path, `of` this robot or arena.
    """
    known, tokens = list(known), _tokens(path)
    matches = [(steps, rest) for steps in known if (rest := _below(tokens, steps)) is not None]
    if not matches:
        raise InputError(_advice(tokens, known, of))
    return matches


def _tokens(path: str) -> list[Token]:
    tokens: list[Token] = []
    place = 0
    while place < len(path):
        match = _TOKEN.match(path, place)
        first_dot = place == 0 and path.startswith(".")
        if match is None or first_dot or (match[0][0] not in ".[" and place > 0):
            raise InputError(_NO_PATH)
        if match["quoted"] is not None:
            tokens.append(_unquoted(match["quoted"]))
        else:
            tokens.append(match["key"] or (int(match["index"]) if match["index"] else ALL))
        place = match.end()
    if not tokens:
        raise InputError(_NO_PATH)
    if tokens[0] == "chain":
        tokens = ["leg", ALL, *tokens]
    if tokens[0] == "leg" and tokens[2:3] == ["chain"] and _get(tokens, 3) in _OF_EVERY_CELL:
        tokens[3:3] = ["cell", ALL]
    return tokens


def _unquoted(text: str) -> str:
    with suppress(ValueError):
        return json.loads(f'"{text}"', strict=False)
    return text


def _below(tokens: list[Token], steps: Steps) -> Steps | None:
    """The part of `steps` below the tokens; None if the tokens do not match."""
    at = 0
    for k, token in enumerate(tokens):
        if at == len(steps):
            return None
        step = steps[at]
        at += 1
        if isinstance(step, Item):
            if token is not ALL and token not in (step.index, step.name):
                return None
        elif (token, step) == ("band", "bands") and isinstance(_get(tokens, k + 1), str | None):
            at += 1  # common to the bands of a cell
        elif token != step:
            return None
    return steps[at:]


def _get(tokens: list[Token], index: int) -> Token | None:
    return tokens[index] if index < len(tokens) else None


def _advice(tokens: list[Token], known: list[Steps], of: str) -> str:
    """Message on the first unknown step of a path, with possible steps."""
    none = f"selects none of this {of}'s numbers"
    for k in range(len(tokens) - 1, -1, -1):
        rests = [rest for steps in known if (rest := _below(tokens[:k], steps)) is not None]
        if rests:
            break
    else:
        return f"{none}: it has none."
    before, wrong = tokens[:k], _shown(tokens[k : k + 1])
    heads = [rest[0] for rest in rests if rest]
    if not heads:
        return f"{none}: {_shown(before)} is one number, leave out the rest."
    options = _options(heads, before if of == "robot" else [of])
    near = nearest_word(wrong.strip(".[]"), options)
    if near:
        meant = [*before, options[near], *tokens[k + 1 :]]
        if not any(_below(meant, steps) is not None for steps in known):
            meant = meant[: k + 1]
        return f"{none}. Did you mean {_shown(meant)}?"
    after = f" after {_shown(before)}" if before else ""
    return f"{none}. Known{after}: {', '.join(options)}."


def _options(heads: Iterable[str | Item], before: list[Token]) -> dict[str, Token]:
    """Possible next steps of a path, by their text."""
    options: dict[str, Token] = {_shown([_token(head)]): _token(head) for head in heads}
    more = ["chain"] if not before else _OF_EVERY_CELL if before[-1] == "chain" else []
    return options | {key: key for key in more}


def _token(step: str | Item) -> str | int:
    return step if isinstance(step, str) else step.index if step.name is None else step.name


def _shown(tokens: Iterable[Token]) -> str:
    path = "".join(f"[{one}]" if isinstance(one, int) else f".{_word(one)}" for one in tokens)
    return path.removeprefix(".")


def _word(token: str | EllipsisType) -> str:
    if not isinstance(token, str):
        return "*"
    return (
        token if re.fullmatch(r"[A-Za-z0-9_-]+", token) else json.dumps(token, ensure_ascii=False)
    )
