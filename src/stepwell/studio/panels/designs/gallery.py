"""The designs that come with Stepwell, for the page's first sight."""

from __future__ import annotations

import tomllib
from functools import cache
from typing import Any

from stepwell import files
from stepwell.studio.wire import Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """Names and titles, chains first."""
    ask.close()
    return View({"designs": _designs()})


@cache
def _designs() -> list[dict[str, Any]]:
    return [_told(name, title) for name, title in files.presets().items()]


def _told(name: str, title: str) -> dict[str, Any]:
    tables = tomllib.loads(files.preset_text(name))
    legs = tables.get("leg", [])
    own = legs[0].get("chain", {}) if legs else {}
    cells = own.get("cell") or tables["chain"]["cell"]
    kind = "robot" if legs else "chain"
    return {"name": name, "title": title, "kind": kind, "cells": len(cells)}
