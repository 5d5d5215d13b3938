"""An atlas as a map: its machines, which lies beside which, and those that do what is asked."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stepwell import files
from stepwell.accounts import account
from stepwell.base import need
from stepwell.studies import (
    QUERIES,
    THREE,
    Atlas,
    Border,
    borders,
    charted,
    find,
    opened,
    understood,
)
from stepwell.studio.panels.atlases._places import placed
from stepwell.studio.panels.studies import store_named
from stepwell.studio.wire import Ask, Design, View

LONG = True
_LONGEST, _MOST = 400, 300


def answer(_design: Design, ask: Ask) -> View:
    """The record of `stepwell atlas show --json`, with places, designs and ways of its machines.

    With a `query`, the names that `stepwell atlas find` finds, and nothing else. `name` is that
    of a store, "" of the atlas that comes with Stepwell.
    """
    need("studies")
    name, query = ask.text("name", 200), ask.text("query", _LONGEST, "")
    least = ask.number("yield_percent", 0.0, 100.0, 0.0)
    ask.close()
    store = store_named(ask, name) if name else THREE
    if query:
        understood(query)  # or refused at once
    found, near = _charted(store, ask)
    if query:
        return View(
            {"query": query, "found": [one.name for one in find(found, query, least / 100)]}
        )
    shown = found.machines[:_MOST]
    names = {one.name for one in shown}
    among = [one for one in near if {one.machine, one.beyond} <= names]
    record = account(found, machines=shown, borders=among).record
    places = placed(found, near, shown)
    for told, machine in zip(record["machines"], shown, strict=True):
        told["design_tables"] = files.tables_in(files.dumps(machine.chain))
        told["x"], told["y"], told["radius"] = places[machine.name]
        told["ways"] = [
            {"from": a, "to": b, "direction": way, "snaps": snaps}
            for a, b, way, snaps in sorted(machine.ways)
        ]
    del record["schema"], record["cycles"]
    return View({**record, "name": name, "phrases": [*QUERIES]})


# What was charted last, by the store and what of it was done: it is asked about again and again.
_KNOWN: dict[Any, tuple[Atlas, tuple[Border, ...]]] = {}
_KEPT = 3


def _charted(store: Path, ask: Ask) -> tuple[Atlas, tuple[Border, ...]]:
    study = opened(store)
    key = str(store), study.identity, tuple(study.done_chunks())
    if key not in _KNOWN:
        found = charted(study, progress=ask.tell)
        while len(_KNOWN) >= _KEPT:
            _KNOWN.pop(next(iter(_KNOWN)))
        _KNOWN[key] = found, borders(study, found)
    return _KNOWN[key]
