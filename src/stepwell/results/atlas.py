"""An atlas as plain numbers, with the unit in every name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import told_in
from stepwell.results.head import head

if TYPE_CHECKING:
    from stepwell.atlas import Atlas, Cycling, Machine
    from stepwell.design import Share
    from stepwell.mechanism import Chain


def atlas_record(found: Atlas, machines: Sequence[Machine] | None = None) -> dict[str, Any]:
    """An atlas, as docs/commands.md describes it.

    Args:
        found: the atlas.
        machines: those of it that are told; all by default.
    """
    shown = found.machines if machines is None else machines
    return {
        **head("stepwell.atlas/1", found.chain, found.seed, "zarr"),
        "title": found.chain.title,
        "cells": len(found.chain),
        "drive": found.drive,
        "space": [_axis(found, axis.name, axis.low, axis.high) for axis in found.axes],
        "designs": found.designs,
        "told": found.told,
        "not_proved": found.not_proved,
        "ties": found.ties,
        "wakes": found.wakes,
        "tolerances": {
            "anchor_mm": found.tolerances.anchor * 1e3,
            "stiffness_percent": found.tolerances.stiffness * 100,
            "rest_length_percent": found.tolerances.rest_length * 100,
        },
        "graphs": len(found.machines),
        "possible": found.possible,
        "space_proved": found.space_proved,
        "whole": found.whole,
        "checked": found.checked,
        "agreed": found.agreed,
        "sampled": {
            "asked": found.sampled.asked,
            "failed": found.sampled.failed,
            "graphs": [
                {"name": name, "designs": times} for name, times in found.sampled.machines.items()
            ],
        },
        "machines": [_machine(found, one) for one in shown],
        "cycles": [_cycling(found, one) for one in found.cycles],
    }


def _axis(found: Atlas, name: str, low: float, high: float) -> dict[str, Any]:
    unit, factor = _told(found, name)
    return {"parameter": name, "unit": unit or "1", "from": low * factor, "to": high * factor}


def _told(found: Atlas, name: str) -> tuple[str, float]:
    from stepwell.design import parameter

    unit = parameter(found.chain, name).unit
    return ("", 1.0) if unit == "1" else told_in(unit)


def _values(found: Atlas, chain: Chain) -> list[float]:
    """What the space varies, of one design of it, in the order and the units of `space`."""
    from stepwell.design import parameter

    return [
        float(parameter(chain, axis.name).value(chain)) * _told(found, axis.name)[1]  # type: ignore[arg-type]
        for axis in found.axes
    ]


def _share(name: str, share: Share) -> dict[str, float]:
    return {
        f"{name}_percent": share.share * 100,
        f"{name}_low_percent": share.low * 100,
        f"{name}_high_percent": share.high * 100,
    }


def _machine(found: Atlas, one: Machine) -> dict[str, Any]:
    return {
        "name": one.name,
        "cycle": one.cycle,
        "designs": one.share.times,
        **_share("share", one.share),
        **_share("yield", one.kept),
        "gap_percent": one.gap * 100,
        "design": one.design,
        "values": _values(found, one.chain),
        "agrees": one.agrees,
        "states": one.states,
        "reached": one.reached,
        "snaps": one.snaps,
        "sub_loops": one.sub_loops,
        "remembers": one.remembers,
        "scrambled": one.scrambled,
        "counts": one.counts,
        "counts_by_hand": one.counts_by_hand,
        "gardens": one.gardens,
        "latches": one.latches,
    }


def _cycling(found: Atlas, one: Cycling) -> dict[str, Any]:
    return {
        "sequence": one.sequence,
        "designs": one.share.times,
        **_share("share", one.share),
        "gap_percent": one.gap * 100,
        "design": one.design,
        "values": _values(found, one.chain),
    }
