"""A transition graph as a file: a figure, or what other programs read."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.base import InputError, write_atomic

if TYPE_CHECKING:
    from stepwell.sequences import TransitionGraph

FIGURES = (".svg", ".png", ".pdf")
EXPORTS = (".graphml", ".dot", ".json")


def checked_suffix(file: str | os.PathLike[str]) -> str:
    """How a transition graph is to be written, by the end of the file's name.

    Raises:
        ValueError: an end that means nothing.
    """
    suffix = Path(file).suffix.lower()
    if suffix not in FIGURES + EXPORTS:
        raise InputError(
            f"{os.fspath(file)}: must end in {', '.join(FIGURES)} for a figure, or in "
            f"{', '.join(EXPORTS)} for other programs."
        )
    return suffix


def write_graph(graph: TransitionGraph, file: str | os.PathLike[str]) -> None:
    """Write a transition graph, whole or not at all.

    Args:
        graph: any; a figure holds at most 64 states with all cells at a stop.
        file: where to; .svg, .png or .pdf is a figure, .graphml, .dot and .json are for other
            programs.

    Raises:
        ValueError: a name with another end, or too many states for a figure.
        OSError: the folder is missing or cannot be written.
    """
    suffix = checked_suffix(file)
    if suffix in FIGURES:
        from stepwell import figures

        figures.save(figures.transition_graph(graph), file)
    else:
        from stepwell.sequences import to_dot, to_graphml, to_json

        written = {".graphml": to_graphml, ".dot": to_dot, ".json": to_json}
        write_atomic(file, written[suffix](graph))
