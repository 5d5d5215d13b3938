"""State machines and regular languages over strokes, and what a chain cannot hold of them."""

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

from stepwell.base import ByValue, InputError

# States of the machine of a language, and maps of states that words give.
_MOST_STATES, _MOST_WORDS = 64, 20_000
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


class Pump(NamedTuple):
    """A word that acts otherwise when it is repeated: no chain under a prescribed force holds it.

    Attributes:
        word: inputs.
        state: the state of the machine before.
        once, twice: its states after the word, and after the word twice.
        period: words until the machine is where it was after some of them: 1 if it settles.
    """

    word: tuple[str, ...]
    state: str
    once: str
    twice: str
    period: int

    def __str__(self):
        word = " ".join(self.word)
        text = (
            f"from '{self.state}', '{word}' leads to '{self.once}', and the same again to "
            f"'{self.twice}'"
        )
        if self.period > 1:
            text += f", and every further '{word}' goes on with period {self.period}"
        return text


@dataclass(frozen=True, eq=False)
class Machine(ByValue):
    """A deterministic state machine whose inputs are strokes.

    Attributes:
        inputs: names of the inputs.
        states: names of the states; it begins in the first.
        moves: the number of the next state, by state and input.
        outputs: the output of each state.
        title: what it does.
    """

    inputs: tuple[str, ...]
    states: tuple[str, ...]
    moves: tuple[tuple[int, ...], ...]
    outputs: tuple[str, ...]
    title: str = ""

    def __post_init__(self):
        for kind, names in (("inputs", self.inputs), ("states", self.states)):
            if not names or len({*names}) < len(names):
                raise InputError(f"{kind} = {[*names]}: give one name or more, each once.")
        right = len(self.moves) == len(self.outputs) == len(self.states)
        right = right and all(len(row) == len(self.inputs) for row in self.moves)
        if not right or any(not 0 <= k < len(self.states) for row in self.moves for k in row):
            raise InputError(
                f"moves = {self.moves}: must be the number of a state for each of "
                f"{len(self.states)} states and {len(self.inputs)} inputs, with one output a state."
            )

    @classmethod
    def parse(cls, text: str) -> "Machine":
        """The machine of a TOML text: a table for each state, or a regular language.

        The keys are `title`, `inputs`, and either `language`, or `start` and for each state
        `[states.NAME]` with the next state for each input, and `output`, by default its name.
        """
        try:
            given = tomllib.loads(text)
        except tomllib.TOMLDecodeError as why:
            raise InputError(f"machine: {why}: must be TOML.") from None
        unknown = sorted({*given} - {"title", "inputs", "language", "start", "states"})
        if unknown:
            raise InputError(
                f"machine: {unknown[0]}: unknown key; use title, inputs, language, start or states."
            )
        inputs = tuple(map(str, given.get("inputs", ())))
        title = str(given.get("title", ""))
        if ("language" in given) == ("states" in given):
            raise InputError("machine: give `language`, or `start` and `states`, and not both.")
        if "language" in given:
            return cls.of_language(str(given["language"]), inputs, title)
        return cls._of_states(given["states"], inputs, str(given.get("start", "")), title)

    @classmethod
    def _of_states(
        cls, rows: Mapping[str, Mapping[str, Any]], inputs: tuple[str, ...], start: str, title: str
    ) -> "Machine":
        names = [*rows]
        if start not in rows:
            raise InputError(f"start = {start!r}: must be one of the states {', '.join(names)}.")
        names = [start, *(name for name in names if name != start)]
        moves: list[tuple[int, ...]] = []
        for name in names:
            row, own = rows[name], f"states.{name}"
            for key in row:
                if key not in (*inputs, "output"):
                    raise InputError(
                        f"{own}.{key}: unknown key; use output or one of the inputs "
                        f"{', '.join(inputs)}."
                    )
            for one in inputs:
                if row.get(one) not in names:
                    raise InputError(
                        f"{own}.{one} = {row.get(one)!r}: must be one of the states "
                        f"{', '.join(names)}."
                    )
            moves.append(tuple(names.index(row[one]) for one in inputs))
        outputs = tuple(str(rows[name].get("output", name)) for name in names)
        return cls(inputs, tuple(names), tuple(moves), outputs, title)

    @classmethod
    def of_language(cls, language: str, inputs: Sequence[str] = (), title: str = "") -> "Machine":
        """The smallest machine whose output is "yes" after the words of a regular language.

        Words are names of inputs with spaces between them; ( ), |, *, + and ? have their usual
        meaning, as in "(short | long)* long short".

        Source: derivatives of regular expressions, Brzozowski 1964.
        """
        tree = _Parser(language).whole()
        used = tuple(dict.fromkeys(_NAME.findall(language)))
        inputs = tuple(inputs) or used
        missing = [name for name in used if name not in inputs]
        if missing:
            raise InputError(f"language: {missing[0]!r} is not among the inputs {[*inputs]}.")
        known, moves = {tree: 0}, list[tuple[int, ...]]()
        for at in (waiting := [tree]):
            row: list[int] = []
            for name in inputs:
                after = _derived(at, name)
                if after not in known:
                    known[after] = len(known)
                    waiting.append(after)
                row.append(known[after])
            moves.append(tuple(row))
            if len(known) > _MOST_STATES:
                raise InputError(
                    f"language: needs more than {_MOST_STATES} states; give a shorter one."
                )
        outputs = tuple("yes" if _empty(one) else "no" for one in known)
        states = tuple(f"s{k}" for k in range(len(known)))
        made = cls(inputs, states, tuple(moves), outputs, title or language).smallest
        return replace(made, states=states[: len(made.states)])

    def _equivalent(self, states: list[int]) -> dict[int, int]:
        """The class of each state: equivalent states give equal outputs for every input."""
        group: dict[int, Any] = {state: self.outputs[state] for state in states}
        while True:
            keys = {s: (group[s], *(group[k] for k in self.moves[s])) for s in states}
            numbers = {key: n for n, key in enumerate(dict.fromkeys(keys.values()))}
            finer = {s: numbers[keys[s]] for s in states}
            if len({*finer.values()}) == len({*group.values()}):
                return finer
            group = finer

    @cached_property
    def smallest(self) -> "Machine":
        """The machine with reachable states only, and equivalent ones as one."""
        reached = [0]
        for state in reached:
            reached += [k for k in dict.fromkeys(self.moves[state]) if k not in reached]
        finer = self._equivalent(reached)
        first = {number: s for s, number in reversed(finer.items())}
        kept = [first[number] for number in range(len(first))]
        return Machine(
            self.inputs,
            tuple(self.states[s] for s in kept),
            tuple(tuple(finer[k] for k in self.moves[s]) for s in kept),
            tuple(self.outputs[s] for s in kept),
            self.title,
        )

    def run(self, inputs: Iterable[str]) -> tuple[str, ...]:
        """The outputs, that of the first state first, after each input of a list."""
        state, outputs = 0, [self.outputs[0]]
        for one in inputs:
            state = self.moves[state][self.inputs.index(one)]
            outputs.append(self.outputs[state])
        return tuple(outputs)

    @cached_property
    def pump(self) -> Pump | None:
        """The shortest word that does not act twice as it acts once; None if every word does.

        Under a prescribed force, without friction, every word acts twice as once (theory page,
        "State machines"). So a machine with such a word needs a prescribed stroke or a spring. A
        word of an even period, as of a parity, is preferred: it needs two states of a chain that
        one program exchanges (`exchange`).
        """
        machine, size = self.smallest, len(self.smallest.states)
        letters = [tuple(row[k] for row in machine.moves) for k in range(len(machine.inputs))]
        seen: dict[tuple[int, ...], tuple[str, ...]] = {}
        front = [*zip(letters, ((name,) for name in machine.inputs), strict=True)]
        found: Pump | None = None
        while front and len(seen) < _MOST_WORDS:
            acts, word = front.pop(0)
            if acts in seen:
                continue
            seen[acts] = word
            for state in range(size):
                if acts[acts[state]] != acts[state]:
                    pump = self._pump(acts, word, state)
                    if found is None or (pump.period > 1 and found.period == 1):
                        found = pump
            more = zip(letters, machine.inputs, strict=True)
            front += [(tuple(a[k] for k in acts), (*word, name)) for a, name in more]
        return found

    def _pump(self, acts: tuple[int, ...], word: tuple[str, ...], state: int) -> Pump:
        path = [state]
        while path.count(path[-1]) < 2:
            path.append(acts[path[-1]])
        names = self.smallest.states
        period = len(path) - 1 - path.index(path[-1])
        return Pump(word, names[state], names[acts[state]], names[acts[acts[state]]], period)

    def __str__(self):
        width = max(map(len, (*self.states, "state")))
        rows = [f"{'state':<{width}}  output  {'  '.join(self.inputs)}"]
        for name, output, row in zip(self.states, self.outputs, self.moves, strict=True):
            rows.append(f"{name:<{width}}  {output}  {'  '.join(self.states[k] for k in row)}")
        return "\n".join(rows)


# A regular expression as nested tuples: ("none",), ("empty",), ("in", name), ("then", a, b),
# ("or", (a, b, ...)) and ("many", a).
_NONE, _EMPTY = ("none",), ("empty",)
_Tree = tuple[Any, ...]


class _Parser:
    """Reads a regular expression."""

    def __init__(self, text: str):
        self.tokens = re.findall(r"[A-Za-z][A-Za-z0-9_-]*|[()|*+?]|\S", text)
        self.at = 0

    def whole(self) -> _Tree:
        tree = self._either()
        if self.at < len(self.tokens):
            raise self._wrong()
        return tree

    def _wrong(self) -> InputError:
        found = self.tokens[self.at] if self.at < len(self.tokens) else "the end"
        return InputError(
            f"language: {found!r} at word {self.at + 1}: must be names of inputs with ( ), |, *, + "
            f"and ?, as in '(short | long)* long'."
        )

    def _next(self) -> str:
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def _either(self) -> _Tree:
        options = [self._sequence()]
        while self._next() == "|":
            self.at += 1
            options.append(self._sequence())
        return _or(options)

    def _sequence(self) -> _Tree:
        tree: _Tree = _EMPTY
        while self._next() not in ("", "|", ")"):
            tree = _then(tree, self._repeated())
        return tree

    def _repeated(self) -> _Tree:
        token = self._next()
        self.at += 1
        if token == "(":
            tree = self._either()
            if self._next() != ")":
                raise self._wrong()
            self.at += 1
        elif _NAME.fullmatch(token):
            tree = ("in", token)
        else:
            self.at -= 1
            raise self._wrong()
        while self._next() in ("*", "+", "?") and self._next():
            sign = self._next()
            self.at += 1
            many = _many(tree)
            tree = {"*": many, "+": _then(tree, many), "?": _or([tree, _EMPTY])}[sign]
        return tree


def _or(options: Iterable[_Tree]) -> _Tree:
    parts: set[_Tree] = set()
    for one in options:
        parts |= {*one[1]} if one[0] == "or" else {one}
    parts.discard(_NONE)
    if len(parts) < 2:
        return next(iter(parts), _NONE)
    return ("or", tuple(sorted(parts, key=repr)))


def _then(a: _Tree, b: _Tree) -> _Tree:
    if _NONE in (a, b):
        return _NONE
    if a == _EMPTY or b == _EMPTY:
        return b if a == _EMPTY else a
    return ("then", a[1], _then(a[2], b)) if a[0] == "then" else ("then", a, b)


def _many(a: _Tree) -> _Tree:
    return a if a[0] == "many" else _EMPTY if a in (_NONE, _EMPTY) else ("many", a)


def _empty(tree: _Tree) -> bool:
    """Whether a regular expression has the empty word."""
    if tree[0] == "then":
        return _empty(tree[1]) and _empty(tree[2])
    return any(map(_empty, tree[1])) if tree[0] == "or" else tree[0] in ("empty", "many")


def _derived(tree: _Tree, name: str) -> _Tree:
    """The rest of all words that begin with an input."""
    if tree[0] == "in":
        return _EMPTY if tree[1] == name else _NONE
    if tree[0] == "or":
        return _or(_derived(one, name) for one in tree[1])
    if tree[0] == "many":
        return _then(_derived(tree[1], name), tree)
    if tree[0] != "then":
        return _NONE
    first = _then(_derived(tree[1], name), tree[2])
    return _or([first, _derived(tree[2], name)]) if _empty(tree[1]) else first
