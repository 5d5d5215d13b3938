"""Certificates of proved paths: JSON that a script without Stepwell checks."""

import hashlib
import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from stepwell.base import InputError
from stepwell.mechanism import Cell, Element, Laws
from stepwell.proof.path_proof import PathProof, ProvedEvent, Theorem
from stepwell.proof.prover import strokes_of
from stepwell.statics import EventKind, problem_of

FORMAT = "stepwell.certificate/1"
# Least half width of a box, as a fraction of the travel: what the engine's doubles can hold.
_LEAST = 1e-15


def certificate(proof: PathProof) -> str:
    """The certificate of a proved path, as JSON.

    It holds the engine's numbers of the cells, hints where forces turn, and for every event boxes
    of stroke and travels. `check_certificate.py` repeats the proof with python-flint alone, and
    checks that each number lies in its box.

    Args:
        proof: the proof of a path.

    Raises:
        ValueError: a path that the script cannot check. It checks chains without friction under a
            prescribed stroke that begin at stops, one cell moving between snaps. Of a snap it
            proves the landing if one of two cells reaches its stop while all others keep still;
            other landings with one cell between its stops are taken from the certificate.
    """
    path, chain = proof.path, proof.path.chain
    problem = problem_of(chain)
    _refuse(proof)
    cells = [_cell(problem, i, cell) for i, cell in enumerate(chain.cells)]
    size = max(cell["size"] for cell in cells)
    data: dict[str, Any] = {
        "format": FORMAT,
        "sha256": "",
        "claim": "Under the stroke, exactly these events happen, in this order, in their boxes.",
        "title": chain.title,
        "scale": problem.scale,
        "cells": cells,
        "start": list(path.start),
        "strokes": [
            {"direction": one.direction, "target": None if one.to_the_end else one.target}
            for one in strokes_of(path, path.events, problem)
        ],
        "events": [_event(one, size) for one in proof.events],
    }
    return json.dumps({**data, "sha256": digest(data)}, indent=1, ensure_ascii=False) + "\n"


def digest(data: dict[str, Any]) -> str:
    """The SHA-256 of a certificate's content."""
    text = json.dumps({**data, "sha256": ""}, sort_keys=True, ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _refuse(proof: PathProof) -> None:
    chain, start = proof.path.chain, proof.path.start
    ends = [s in (c.low, c.high) for s, c in zip(start, chain.cells, strict=True)]
    reasons = {
        "the path is not proved": not proof.proved,
        "the actuator is compliant or prescribes a force": np.isfinite(chain.actuator_stiffness),
        "a cell has friction": any(cell.friction > 0 for cell in chain.cells),
        "a cell begins between its stops": not all(ends),
        "an element has a curve that folds back": any(len(e.laws) > 1 for e in chain.elements),
    }
    for reason, holds in reasons.items():
        if holds:
            raise InputError(f"{reason}: such a path has no certificate that the script can check.")


def _event(proved: ProvedEvent, size: float) -> dict[str, Any]:
    event, half = proved.event, max(_LEAST * size, 2 * proved.travel_error)
    wide = max(8 * _LEAST * size, 2 * proved.stroke_error)
    snap = event.kind is EventKind.SNAP
    moved = sorted(zip(event.cells, event.after, strict=True))
    # Of a snap that no line leads to its landing the script takes the landing as it is claimed.
    taken = proved.theorem not in (None, Theorem.LINE)
    return {
        **({"taken": True} if taken else {}),
        "kind": "snap" if snap else "switch",
        "cells": [cell for cell, _ in moved],
        "stroke": [event.stroke, wide],
        "after": [[travel, half] for _, travel in moved],
    }


def _cell(problem: Any, i: int, cell: Cell | Element) -> dict[str, Any]:
    from stepwell.proof.laws import turns_of

    laws, table = problem.laws, problem.sheets.table
    sheet = int(problem.sheets.now[i])
    turns, signs = turns_of(problem, sheet)
    lever = float(laws.lever[i]) if isinstance(cell, Cell) else None
    return {
        "low": float(table[sheet, 0]),
        "high": float(table[sheet, 1]),
        "size": float(laws.full[i]),
        "lever": lever,
        "sine": float(laws.sin_limit[i]),
        "mobility": float(problem.mobility[i]),
        "turns": turns,
        "signs": signs,
        "laws": list(_laws(laws, i)),
    }


def _laws(laws: Laws, i: int) -> Iterator[dict[str, Any]]:
    for b in range(int(laws.band_first[i]), int(laws.band_first[i + 1])):
        dx, dy, stiffness, rest = laws.band[b].tolist()
        rows = laws.rows[laws.band_rows[b] : laws.band_rows[b + 1], :5].tolist()
        slack = not laws.two_sided[b]
        yield {"d": [dx, dy], "k": stiffness, "rest": rest, "slack": slack, "rows": rows}
    first, last = laws.load_rows[i].tolist()
    if last > first:
        rows = laws.rows[first:last, :5].tolist()
        yield {"d": None, "k": 1.0, "rest": 0.0, "slack": False, "rows": rows}
