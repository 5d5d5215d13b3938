"""Every command with its arguments and options, as a table of few lines."""

from typing import Any

from golden.cases import commands
from golden.reducing import brief


def options() -> dict[str, dict[str, str]]:
    """For each command its arguments and options: what each takes, its default, what is allowed."""
    return {
        name or "stepwell": {"/".join(one.opts): _described(one) for one in command.params}
        for name, command in commands()
    }


def _described(one: Any) -> str:
    kind = one.type_descriptor.annotation
    flag = getattr(one, "is_flag", False)
    words = ["flag" if flag else one.metavar or getattr(kind, "__name__", str(kind))]
    if one.min is not None or one.max is not None:
        words.append(f"{'' if one.min is None else one.min}..{'' if one.max is None else one.max}")
    words += ["required"] * one.required
    words += ["many"] * (one.multiple or one.nargs == -1)
    shown = one.show_default
    default = shown if isinstance(shown, str) else one.default
    if default is not None and default is not False and default != () and not callable(default):
        words.append(f"default {brief(str(default))}")
    return " ".join(words)
