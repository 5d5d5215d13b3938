"""Claims are judged by what is computed: a wrong value or another model changes the verdict."""

import dataclasses
import re
from types import SimpleNamespace

import numpy as np
import pytest

from facts import refuses, says
from stepwell import paper
from stepwell.mechanism import Band
from stepwell.paper import (
    Judgement,
    cells as _cells,
    cells as designs,
    cells as misprints,
    pathways,
    pathways as _wells,
    pathways as map,
)
from stepwell.paper.claims import finding_of
from stepwell.sequences import Pathway


def judge(name: str) -> paper.ClaimVerdict:
    (claim,) = (claim for claim in paper.claims() if claim.id == name)
    return claim.judge()


def test_every_claim_has_a_name_of_its_own_and_says_where_and_what():
    claims = paper.claims()
    assert len({claim.id for claim in claims}) == len(claims)
    for claim in claims:
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", claim.id)
        assert claim.claim.endswith(".")
        assert all((claim.where, claim.paper_value, claim.tolerance))


def test_listing_the_claims_computes_nothing(monkeypatch):
    monkeypatch.setattr(map, "transition_map", None)
    assert paper.claims()


def test_progress_is_reported_for_every_claim(known_verdicts):
    reported = []
    paper.run(progress=lambda done, total: reported.append((done, total)))
    total = len(paper.claims())
    assert reported == [(k + 1, total) for k in range(total)]


def test_a_verdict_reads_as_one_line(verdicts):
    (verdict,) = (one for one in verdicts if one.claim.id == "share-clockwise")
    says(repr(verdict), "Verdict(share-clockwise agrees", "paper 0.215", "ours 0.215")


def test_a_difference_without_a_reason_is_refused():
    with refuses(ValueError, "verdict = ", "a reason"):
        paper.Finding("2", Judgement.DIFFERS)
    assert finding_of(False, "2").reason


def test_a_force_away_from_the_papers_differs(monkeypatch):
    monkeypatch.setitem(_cells.FORCES, "(10, 0)", (0.967, -0.965))
    assert judge("force-10-0").verdict is Judgement.DIFFERS


@pytest.fixture
def other_cell(monkeypatch):
    """Puts another cell in the place of the one with q = (10, 0) mm."""

    def put(**changes):
        cells = dict(designs.six_cells())
        band = dataclasses.replace(cells["(10, 0)"].bands[0], **changes)
        cells["(10, 0)"] = dataclasses.replace(cells["(10, 0)"], band=band)
        monkeypatch.setattr(_cells, "six_cells", lambda: cells)

    return put


def test_a_cell_whose_force_rises_is_not_called_falling(other_cell):
    other_cell(q=(-0.012, 0.0))
    verdict = judge("force-falls")
    assert verdict.verdict is Judgement.DIFFERS
    assert "(10, 0)" in verdict.reason


def test_another_monostable_cell_is_noticed(other_cell):
    other_cell(q=(0.0, 0.015))
    assert judge("bistable").verdict is Judgement.DIFFERS


def test_forces_that_are_no_slope_of_the_energy_are_noticed(monkeypatch):
    true = Band.force
    monkeypatch.setattr(Band, "force", lambda *a: true(*a) * (1 + 1e-5))
    assert judge("curves").verdict is Judgement.DIFFERS


def test_a_pair_that_takes_another_pathway_is_noticed(monkeypatch):
    swapped = {**designs.PAIRS, Pathway.CLOCKWISE: "paper-via-10"}
    monkeypatch.setattr(
        pathways, "pair_cycle", lambda pathway: designs.preset(swapped[pathway]).cycle()
    )
    assert judge("pathway-clockwise").verdict is Judgement.DIFFERS
    # It does not snap, either.
    assert judge("directed-snaps").verdict is Judgement.DIFFERS


def test_a_directed_pair_among_the_undirected_is_noticed(monkeypatch):
    swapped = {**designs.PAIRS, Pathway.VIA_01: "paper-forward"}
    monkeypatch.setattr(
        pathways, "pair_cycle", lambda pathway: designs.preset(swapped[pathway]).cycle()
    )
    assert judge("undirected-boundary").verdict is Judgement.DIFFERS


def test_two_cells_in_transit_at_once_are_noticed(monkeypatch):
    together = SimpleNamespace(
        chain=designs.preset("paper-forward"),
        path=SimpleNamespace(travel=np.array([[0.0, 0.0], [0.005, 0.005], [0.02, 0.02]])),
        snaps=(),
    )
    monkeypatch.setattr(pathways, "pair_cycle", lambda pathway: together)
    assert judge("sequential").verdict is Judgement.DIFFERS


def test_a_wrong_share_of_the_map_differs(monkeypatch):
    monkeypatch.setitem(map.SHARES, Pathway.CLOCKWISE, 0.217)
    assert judge("share-clockwise").verdict is Judgement.DIFFERS


def test_the_shares_of_the_map_fill_it(verdicts):
    names = {f"share-{name}" for name in ("clockwise", "counterclockwise", "via-01", "via-10")}
    shares = [float(one.ours) for one in verdicts if one.claim.id in names]
    assert len(shares) == 4 and sum(shares) == pytest.approx(1, abs=0.002)


def test_the_claim_on_qx_would_agree_on_a_map_where_it_holds(monkeypatch):
    real = map.paper_map()
    row = np.where(np.arange(400) % 20 < np.arange(400) // 20, 0, 2)
    made = dataclasses.replace(real, pathway=np.tile(row.astype(np.int8), (400, 1)))
    monkeypatch.setattr(map, "paper_map", lambda: made)
    assert judge("large-qx-directed").verdict is Judgement.AGREES
    assert judge("large-qy-undirected").verdict is Judgement.DIFFERS


def test_a_bistable_outer_cell_does_not_prove_the_claim_on_wells(monkeypatch):
    monkeypatch.setattr(_wells, "monostable_pair", lambda: designs.pair_cycle(Pathway.CLOCKWISE))
    assert judge("wells").verdict is Judgement.DIFFERS


def test_centimetres_would_agree_if_the_forces_were_theirs(monkeypatch):
    cell = designs.six_cells()["(10, 0)"]
    band = cell.bands[0]
    in_cm = cell.with_anchors((10 * band.p[0], 0.0), (10 * band.q[0], 0.0))
    theirs = in_cm.force_0 / (band.stiffness * cell.lever)
    monkeypatch.setitem(misprints.FORCES, "(10, 0)", (theirs, 0.0))
    assert judge("anchor-unit").verdict is Judgement.AGREES


BOWL = np.add.outer(np.linspace(-1, 1, 41) ** 2, np.linspace(-1, 1, 41) ** 2)


@pytest.mark.parametrize(
    ("energy", "wells"),
    [
        (BOWL, 1),
        (-BOWL, 4),  # the corners
        (np.add.outer(np.arange(5.0), np.arange(7.0)), 1),  # a slope: its lowest corner
        (np.add.outer(np.cos(np.linspace(0, 4 * np.pi, 81)), np.zeros(9)), 2),  # two valleys
        (np.zeros((5, 5)), 1),  # flat
    ],
)
def test_wells_are_counted_with_edges_and_flat_ones_once(energy, wells):
    assert _wells.count_minima(energy) == wells


@pytest.mark.parametrize("pathway", designs.PAIRS)
def test_two_ways_of_counting_wells_agree_for_every_pair(pathway):
    chain = designs.pair_cycle(pathway).chain
    assert len(_wells.stable_states(chain)) == _wells.count_minima(_wells.landscape(chain, 101))


def test_wells_of_a_cell_without_the_proof_are_not_read_off_its_ends():
    with pytest.raises(ValueError, match="proved to fall"):
        _wells.stable_states(designs.preset("rubber"))
