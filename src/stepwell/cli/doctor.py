"""`stepwell doctor`: what is installed, what is kept, what is missing here."""

import typer

from stepwell.accounts import account
from stepwell.base import installation
from stepwell.cli.options import Json
from stepwell.cli.screen import FAILED, has_display, report


def doctor(as_json: Json = False) -> None:
    """List what is installed, what is kept and what is missing.

    Packages and extras with the command that adds each, compiled kernels and where they are kept,
    browser, video encoder and OpenGL, cores. What is installed and does not work is listed with the
    reason. It ends with 0 where all that Stepwell needs is installed, extras or not.
    """
    found = installation(
        {"cores": _cores, "kernels": _kernels, "OpenGL": _opengl, "display": _display}
    )
    report(account(found), as_json)
    if not found.ok:
        raise typer.Exit(FAILED)


# Each opens its room when it is called: what is broken there is reported, and the rest examined.
def _cores() -> int:
    from stepwell.kernels import cores

    return cores()


def _kernels() -> object:
    from stepwell.kernels import kept

    return kept()


def _opengl() -> str | None:
    from stepwell.simulation import drawing_system

    return drawing_system()


def _display() -> str | None:
    return "yes" if has_display() else None
