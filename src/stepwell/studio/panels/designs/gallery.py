"""The designs that come with Stepwell, for the page's first sight."""

from __future__ import annotations

import tomllib
from functools import cache
from typing import Any

from stepwell import files
from stepwell.studio.wire import Ask, Design, View

# The groups in the order of the page.
_GROUPS = ("paper", "further", "elements", "robots")


def answer(_design: Design, ask: Ask) -> View:
    """Names, titles and groups, in the order of the page."""
    ask.close()
    return View({"designs": _designs()})


def names() -> list[str]:
    """The names of all designs in the order of the page."""
    return [one["name"] for one in _designs()]


@cache
def _designs() -> list[dict[str, Any]]:
    told = [_told(name, title) for name, title in files.presets().items()]
    return sorted(told, key=lambda one: _GROUPS.index(one["group"]))


def _told(name: str, title: str) -> dict[str, Any]:
    tables = tomllib.loads(files.preset_text(name))
    legs = tables.get("leg", [])
    own = legs[0].get("chain", {}) if legs else {}
    cells = own.get("cell") or tables["chain"]["cell"]
    kind = "robot" if legs else "chain"
    group = _group(name, kind, cells)
    return {"name": name, "title": title, "kind": kind, "group": group, "cells": len(cells)}


def _group(name: str, kind: str, cells: list[dict[str, Any]]) -> str:
    if kind == "robot":
        return "robots"
    # Cells of levers have bands, and bands have anchors.
    if not all("p_mm" in cell or "bands" in cell for cell in cells):
        return "elements"
    return "paper" if name.startswith("paper-") else "further"
