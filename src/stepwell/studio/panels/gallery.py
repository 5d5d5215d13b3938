"""The designs that come with Stepwell, for the page's first sight."""

from __future__ import annotations

from functools import cache
from typing import Any

from stepwell import files
from stepwell.mechanism import Chain
from stepwell.studio.wire import Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """Names and titles, chains first."""
    ask.close()
    return View({"designs": _designs()})


@cache
def _designs() -> list[dict[str, Any]]:
    return [_told(name, title) for name, title in files.presets().items()]


def _told(name: str, title: str) -> dict[str, Any]:
    design = files.preset(name)
    chain = design if isinstance(design, Chain) else design.legs[0].chain
    kind = "chain" if design is chain else "robot"
    return {"name": name, "title": title, "kind": kind, "cells": len(chain)}
