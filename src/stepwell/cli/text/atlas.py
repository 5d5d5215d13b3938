"""An atlas as people read it: what there is, how often, how sure, and what is proved."""

from __future__ import annotations

from typing import Any

from stepwell.cli.screen import show_facts, show_records, show_text
from stepwell.results import ATLAS_MACHINES, atlas_assumed, atlas_facts

# Rows of a table; --json has all.
_ROWS = 15


def atlas(record: dict[str, Any]) -> None:
    """Print what `results.atlas_record` returns."""
    show_facts(record, atlas_facts(record), 8)
    _show_machines("Machines, most frequent first", record["machines"])
    show_text(atlas_assumed(record))


def found(record: dict[str, Any]) -> None:
    """Print the machines of such a record that were asked for."""
    if not record["machines"]:
        show_text("No machine of this atlas does that.")
        return
    _show_machines("Machines that do that, highest yield first", record["machines"])
    show_text(atlas_assumed(record))


def _show_machines(title: str, machines: list[dict[str, Any]]) -> None:
    show_records(title, ATLAS_MACHINES, machines[:_ROWS])
    if len(machines) > _ROWS:
        show_text(f"and {len(machines) - _ROWS} more: --json has all.")
