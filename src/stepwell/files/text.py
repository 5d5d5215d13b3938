"""Text of design files: reading and writing TOML, exact decimals, error messages."""

import json
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, InvalidOperation
from functools import cache
from importlib.resources import files
from typing import Any

from stepwell.base import UNITS, InputError, limits, nearest_word, printable

MOST_LINES = 40
# More digits than a float can have (767), so a shift of the decimal point never rounds.
_EXACT = Context(prec=800, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
_ENOUGH = Context(prec=60, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


class DesignError(InputError):
    """A design file that cannot be used; `str` of it is the message for the user.

    Args:
        name: the file, as named by the user.
        problems: one line each: place, value, allowed values, probable intention.
        more: number of further problems.
    """

    def __init__(self, name: str, problems: Iterable[str], more: int = 0):
        self.name = printable(name)
        self.problems = tuple(problems)
        lines = [f"{self.name}: {problem}" for problem in self.problems[:MOST_LINES]]
        if (unlisted := len(self.problems) + more - len(lines)) > 0:
            lines.append(f"{self.name}: and {unlisted} more problems.")
        super().__init__("\n".join(lines))


def refuse_any(name: str, problems: Collection[str]) -> None:
    """Raise a DesignError if there are problems."""
    if problems:
        raise DesignError(name, problems)


def key_path(keys: Sequence[str | int]) -> str:
    """("chain", "cell", 1, "q_mm") as chain.cell[1].q_mm."""
    path = ""
    for key in keys:
        if isinstance(key, int):
            path += f"[{key}]"
            continue
        bare = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
        shown = key if bare else json.dumps(key, ensure_ascii=False)
        path += ("." if path else "") + _cut(printable(shown))
    return path


def value_text(value: Any) -> str:
    """A value as in a file, on one short line."""
    if isinstance(value, dict | list | tuple):
        keyed, more = isinstance(value, dict), ["..."] * (len(value) > 4)
        first = [key_path([str(one)]) if keyed else value_text(one) for one in [*value][:4]]
        return _cut(("{%s}" if keyed else "[%s]") % ", ".join(first + more))
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int) and abs(value) >= 10**15:
        return f"an integer of {value.bit_length()} bits"
    if isinstance(value, Decimal):
        if value.is_nan():
            return "nan"
        return "-inf" * value.is_signed() or "inf" if value.is_infinite() else _cut(str(value))
    if isinstance(value, str):
        return _cut(printable(json.dumps(value[:80], ensure_ascii=False)))
    return _cut(printable(str(value)))


@cache
def packaged(folder: str) -> dict[str, str]:
    """Texts of the files in a folder of this package, by name without ending, sorted by name."""
    every = sorted((files("stepwell.files") / folder).iterdir(), key=lambda file: file.name)
    return {
        file.name.rpartition(".")[0]: file.read_text("utf-8")
        for file in every
        if file.name.endswith((".toml", ".txt"))
    }


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A sentence with the nearest known word, or with all if none is near."""
    near = nearest_word(word, known := list(known))
    return f"Did you mean {near}?" if near else f"Known here: {', '.join(known)}."


def _cut(text: str, most: int = 60) -> str:
    return text if len(text) <= most else text[: most - 3] + "..."


def in_decimals(value: Any, name: str) -> Any:
    """A value as in a file, with numbers as the decimals that Python prints; or a DesignError."""
    problems: list[str] = []
    decimals = _in_decimals(value, problems, ())
    refuse_any(name, problems)
    return decimals


def _in_decimals(value: Any, problems: list[str], keys: Sequence[str | int]) -> Any:
    if isinstance(value, float):
        return Decimal(repr(value))
    if isinstance(value, str | int | Decimal):
        return value
    if len(keys) > limits.most("depth"):
        problems.append(f"{key_path(keys[:1])}: is nested too deeply to be a design file.")
    elif isinstance(value, dict):
        return {
            str(key): _in_decimals(own, problems, (*keys, str(key))) for key, own in value.items()
        }
    elif isinstance(value, list | tuple):
        return [_in_decimals(own, problems, (*keys, i)) for i, own in enumerate(value)]
    else:
        shown = "null" if value is None else value_text(value)
        problems.append(
            f"{key_path(keys)} = {shown}: must be text, a number, true, false, a list or a table; "
            f"leave out the key for no value."
        )
    return None


def in_floats(value: Any) -> Any:
    """A value of a file as a JSON value, with decimals as floats."""
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, dict):
        return {key: in_floats(own) for key, own in value.items()}
    if isinstance(value, list):
        return [in_floats(own) for own in value]
    return value


# Keys of a table with their values as text.
Written = dict[str, str]

# Possible begin of a key; the patterns never backtrack. The reader is quadratic in a key's depth.
_KEY = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_BEGIN = r"(?:^|[\[{,])[ \t]*+"


def parsed(text: str, name: str, empty: str) -> dict[str, Any]:
    """Tables of a file; DesignError if it is no TOML, with the message `empty` if it is empty."""
    if not text.strip():
        raise DesignError(name, [empty])
    _refuse_deep(text, name)
    # Keys are counted by their signs before the much slower reading.
    if (keys := text.count("=")) > limits.most("keys"):
        raise DesignError(name, [f"has {limits.problem('keys', keys)}"])
    try:
        return tomllib.loads(text.replace("\r\n", "\n"), parse_float=_decimal)
    except RecursionError:
        problem = "is nested too deeply to be a design file."
    except tomllib.TOMLDecodeError as error:
        problem = f"{error}."
        if place := re.search(r" \(at (?:(line \d+, column \d+)|end of document)\)$", str(error)):
            where = place[1] or f"line {text.count(chr(10)) + 1}, at the end"
            problem = f"{where}: {str(error)[: place.start()]}.{_slip_hint(text, place[1])}"
    except ValueError:
        problem = "holds an integer of thousands of digits."
    raise DesignError(name, [problem])


def _slip_hint(text: str, place: str | None) -> str:
    """A sentence on a decimal comma or a missing comma in the line of a syntax error."""
    line = text.split("\n")[int(place.split()[1].strip(",")) - 1] if place else ""
    if number := re.search(r"=\s*([+-]?\d+),(\d+)", line):
        return f" Numbers have a decimal point: {number[1]}.{number[2]}."
    if pair := re.search(r"[\[,]\s*([+-]?[\d.]+)\s+([+-]?[\d.]+)", line):
        return f" A comma is missing between the numbers: {pair[1]}, {pair[2]}."
    return ""


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text)
    except InvalidOperation:  # an exponent past a billion billion
        return Decimal(float(text))


def _refuse_deep(text: str, name: str) -> None:
    """Raise DesignError if a key is nested more deeply than in any design."""
    most = limits.most("depth")
    if text.count(".") <= most:
        return
    deep = re.search(rf"{_BEGIN}{_KEY}(?:[ \t]*+\.[ \t]*+{_KEY}){{{most},}}+", text, re.MULTILINE)
    if deep:
        line = text.count("\n", 0, deep.start()) + 1
        names = len(re.findall(_KEY, deep[0]))
        raise DesignError(name, [f"line {line}: has {limits.problem('depth', names)}"])


def array(items: Iterable[str]) -> str:
    """A list of items in TOML."""
    return f"[{', '.join(items)}]"


def inline(keys: Mapping[str, str]) -> str:
    """A table on one line."""
    return "{ " + ", ".join(lines(keys)) + " }"


def lines(keys: Mapping[str, str]) -> list[str]:
    """A line for each key."""
    return [f"{key} = {value}" for key, value in keys.items()]


def quoted(text: str) -> str:
    """Text in quotes."""
    # JSON's escapes are TOML's, but TOML also wants the delete character escaped.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def exact_si(number: Decimal, unit: str) -> float:
    """The float in SI nearest to a decimal in a unit of files: 45 deg is `math.pi / 4`.

    The decimal point is shifted and the result rounded once: 10 mm is the float 0.01.
    """
    if unit == "deg":
        return float(_ENOUGH.divide(_ENOUGH.multiply(number, _PI), Decimal(180)))
    return float(_EXACT.scaleb(number, _places(unit)))


def shortest(value: float, unit: str) -> Decimal:
    """The shortest decimal in a unit of files that `exact_si` reads back as `value`."""
    if unit != "deg":
        return _EXACT.scaleb(Decimal(repr(float(value))), -_places(unit))
    exact = _ENOUGH.divide(_ENOUGH.multiply(Decimal(value), Decimal(180)), _PI)
    # A float has 17 digits; the angle in degrees needs at most one more.
    candidates = (Context(prec=digits).plus(exact) for digits in range(1, 20))
    return next(candidate for candidate in candidates if exact_si(candidate, unit) == value)


def _places(unit: str) -> int:
    places = UNITS[unit].places
    assert places is not None, f"{unit} is not a power of ten of its SI unit"
    return places


def toml(number: Decimal) -> str:
    """A decimal in TOML: an integer if it is one, without an exponent if short."""
    number = number.normalize(_EXACT)
    if number.is_zero():
        return "-0.0" if number.is_signed() else "0"
    return format(number, "f" if -7 < number.adjusted() < 15 else "e")
