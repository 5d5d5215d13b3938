"""`stepwell doctor`: what is installed, what is kept, what is missing here."""

from __future__ import annotations

import platform
import shutil
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import typer

from stepwell.base import EXTRAS, Column, Extra, Quantity, Schema, __version__
from stepwell.cli.options import Json
from stepwell.cli.screen import (
    FAILED,
    finish,
    has_display,
    show_facts,
    show_lines,
    show_records,
    show_verbatim,
)

# As pyproject.toml has them, of which a test makes sure; a checkout that is not installed knows
# nothing of it. What extras bring is in `base`.
NEEDED = (
    "filelock", "networkx", "numba", "numpy", "platformdirs", "pydantic", "rich", "scipy",
    "tomli-w", "typer",
)  # fmt: skip
_PACKAGE: Schema = (
    Quantity("name", head="package"),
    Quantity("version", head="version", none="missing"),
)
_EXTRA: Schema = (
    Quantity("name", head="extra"),
    Quantity("used_for", head="used for"),
    Quantity("present"),
    Quantity("install"),
)
_TOOL: Schema = (
    Quantity("name", head="tool"),
    Quantity("used_for", head="used for"),
    Quantity("found", head="here", none="no"),
)


def doctor(as_json: Json = False) -> None:
    """Say what is installed, what is kept and what is missing.

    Packages and extras with the command that adds each, compiled kernels and where they are kept,
    browser, video encoder and OpenGL, cores. It ends with 0 where all that Stepwell needs is
    there, extras or not.
    """
    record = examined()
    finish(record, _show, as_json)
    if not record["ok"]:
        raise typer.Exit(FAILED)


def examined() -> dict[str, Any]:
    """What `stepwell doctor --json` prints."""
    packages = [{"name": name, "version": _version(name)} for name in NEEDED]
    whole = all(one["version"] for one in packages)
    extras = [_extra(name, one) for name, one in EXTRAS.items()]
    return {
        "schema": "stepwell.doctor/1",
        "stepwell": __version__,
        "ok": whole,
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "cores": _cores() if whole else None,
        "packages": packages,
        "extras": extras,
        "kernels": _kernels() if whole else None,
        "tools": _tools({one["name"] for one in extras if one["present"]}),
    }


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _extra(name: str, extra: Extra) -> dict[str, Any]:
    found = {package: _version(package) for package in extra.packages}
    return {
        "name": name,
        "used_for": extra.used_for,
        "present": all(found.values()),
        "versions": {package: told for package, told in found.items() if told},
        "install": f"pip install 'stepwell[{name}]'",
    }


def _cores() -> int:
    from stepwell.kernels import cores

    return cores()


def _kernels() -> dict[str, Any]:
    from stepwell.kernels import kept

    found = kept()
    return {
        "folder": str(found.folder),
        "writable": found.writable,
        "compiled": found.compiled,
        "size_MB": found.size / 1e6,
    }


def _tools(extras: set[str]) -> list[dict[str, Any]]:
    tools = (
        ("browser", "opening the studio's page", _browser()),
        (
            "Chromium",
            "the tests of the page",
            _path("chromium", "chromium-browser", "google-chrome"),
        ),
        ("H.264 encoder", "videos as MP4", _encoder() if "video" in extras else None),
        ("OpenGL", "drawing robots off screen", _opengl() if "robot" in extras else None),
        ("display", "`stepwell view`", _display()),
    )
    return [{"name": name, "used_for": what, "found": found} for name, what, found in tools]


def _path(*names: str) -> str | None:
    return next((found for name in names if (found := shutil.which(name))), None)


def _browser() -> str | None:
    import webbrowser

    try:
        return getattr(webbrowser.get(), "name", "yes")
    except webbrowser.Error:
        return None


def _encoder() -> str | None:
    from importlib import import_module

    try:
        return import_module("av").Codec("libx264", "w").name
    except (ImportError, ValueError):
        return None


def _opengl() -> str | None:
    from stepwell.simulation import drawing_system

    return drawing_system()


def _display() -> str | None:
    return "yes" if has_display() else None


def _show(record: dict[str, Any]) -> None:
    kernels = record["kernels"]
    missing = [one["name"] for one in record["packages"] if one["version"] is None]
    found = {
        "Verdict": "all that Stepwell needs is here" if record["ok"] else "packages are missing",
        "Missing": ", ".join(missing),
        "Repair": missing and "pip install --upgrade --force-reinstall stepwell",
        "Stepwell": f"{record['stepwell']}, Python {record['python']}, {record['system']}",
        "Cores": record["cores"],
        "Kernels": kernels and f"{kernels['compiled']} compiled, {kernels['size_MB']:.0f} MB",
        "Kept in": kernels and kernels["folder"],
        "Writable": kernels
        and ("yes" if kernels["writable"] else "no: name a folder with NUMBA_CACHE_DIR"),
    }
    show_facts({"title": ""}, found, 10)
    show_records("Packages", _PACKAGE, record["packages"], most=None)
    name, used_for, *_ = _EXTRA
    here = Column("here", lambda one: _versions(one) if one["present"] else "no")
    show_records("Extras", [name, used_for, here], record["extras"], most=None)
    lacking = [one["install"] for one in record["extras"] if not one["present"]]
    if lacking:
        show_lines("", "What is missing comes with:")
        show_verbatim("\n".join(lacking))
    show_records("Tools", _TOOL, record["tools"], most=None)
    if not record["ok"]:
        show_lines("", "Nothing else was looked at before the packages are there.")


def _versions(extra: Any) -> str:
    return ", ".join(f"{name} {told}" for name, told in extra["versions"].items())
