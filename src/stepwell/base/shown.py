"""Display of values: a card in a notebook, the default figure, a short representation."""

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

T = TypeVar("T")


class Shown:
    """A value that a notebook shows as a card: its kind, its statement, its main numbers."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        from stepwell.accounts import card_of

        return card_of(self)


class Drawn:
    """A value with a default figure."""

    __slots__ = ()

    def plot(self, **options: Any) -> "Figure":
        """Plot the default figure, which a notebook displays.

        Args:
            options: of the function in `stepwell.figures` that draws it, see `figures.plot`.

        Raises:
            ValueError: the value has nothing to draw, or too much for a readable figure.
        """
        from stepwell.figures import plot

        return plot(self, **options)


def brief(value: Any) -> str:
    """Representation of a dataclass or named tuple, with numbers rounded to four digits.

    It has the fields of the default representation.
    """
    known = getattr(value, "_fields", None)
    names = known or [one.name for one in fields(value) if one.repr]
    shown = ", ".join(f"{name}={_value_text(getattr(value, name))}" for name in names)
    return f"{type(value).__name__}({shown})"


def _value_text(value: Any) -> str:
    if isinstance(value, bool | str) or value is None:
        return repr(value)
    if isinstance(value, float):
        return f"{value:.4g}"
    if hasattr(value, "shape") and value.shape:
        return f"<{' by '.join(map(str, value.shape))} numbers>"
    if type(value) in (tuple, list):
        inside = ", ".join(map(_value_text, value))
        return f"[{inside}]" if isinstance(value, list) else f"({inside}{',' * (len(value) == 1)})"
    return repr(value)


def of_kind(table: Mapping[str, T], value: object) -> T | None:
    """The entry of a table for the class of a value, or for its nearest base class, by name.

    By names, so that unused modules, such as MuJoCo's, are not imported.
    """
    ours = (kind for kind in type(value).__mro__ if kind.__module__.startswith("stepwell."))
    return next((table[kind.__name__] for kind in ours if kind.__name__ in table), None)
