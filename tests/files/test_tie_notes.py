"""Ties are told once for what is done about them, not once for every place."""

from dataclasses import replace

import stepwell as sw
from facts import says
from stepwell.accounts import tie_notes

FIRST, SECOND = sw.preset("paper-forward").cells


def notes(*cells: sw.Cell) -> list[str]:
    chain = sw.Chain(tuple(replace(cell, name="") for cell in cells))
    ties = chain.cycle().degenerate
    assert len({str(tie) for tie in ties}) > 2
    return tie_notes(ties, chain)


def test_a_chain_with_every_band_slack_is_reported_so_once():
    slack = sw.Cell(sw.Band((-0.01, 0.0), (0.01, 0.0), 28.5, 0.2))
    (note,) = notes(slack, slack)
    says(note, "inner and outer", "same constant force", "20 mm", "40, 0 mm")


def test_cells_that_are_alike_are_reported_once_with_their_names():
    (note,) = notes(FIRST, FIRST, FIRST, FIRST)
    says(note, "cell 1", "cell 4", "tie", "0 mm", "all of", *(f"cell {k}" for k in range(1, 5)))
    says(note, "alike", "also at", "20, 40, ")


def test_pairs_that_differ_keep_their_own_notes():
    found = notes(FIRST, FIRST, SECOND, SECOND)
    assert [note[:17] for note in found if " tie at " in note] == [
        "cell 1 and cell 2",
        "cell 3 and cell 4",
    ]
    assert len(found) == 3  # and where the snap of the inner ones lands


def test_under_a_force_the_places_are_forces():
    chain = sw.Chain((FIRST, FIRST), actuator_stiffness=0.0)
    for note in tie_notes(chain.cycle().degenerate, chain):
        assert " mm" not in note.partition("The same holds")[2]
