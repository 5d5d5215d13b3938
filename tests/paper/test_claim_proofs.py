"""Claims of the paper that enclosures prove, as the page shows them."""

import re

import numpy as np
import pytest

import stepwell as sw
from docs.proofs import SAMPLES, TABLES, box_row, claim_row, margin_row, random_chains, shown
from stepwell import preset
from stepwell.base import have
from stepwell.paper import claim_proofs, proofs
from stepwell.sequences import Pathway

pytestmark = pytest.mark.skipif(not have("proof"), reason="needs python-flint")
# Presets whose rows are computed again here; the script computes all.
ROWS = "paper-backward", "three-wave", "used-before", "paper-identical", "von-mises-truss"


@pytest.fixture(scope="module")
def claims():
    """All proofs, those of the map with rectangles that are half a millimetre wide."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(proofs, "_FINEST", 500e-6)
        proofs.map_areas.cache_clear()
        yield claim_proofs()
        proofs.map_areas.cache_clear()


def test_the_page_has_the_proofs_of_all_claims_but_the_map_to_the_letter(claims):
    rows = set(shown("claims").splitlines())
    of_the_map = [one for one in claims if one.statement.startswith(("between", "enclosed shares"))]
    assert len(of_the_map) == 6 and len(claims) == 26
    assert {claim_row(one) for one in claims if one not in of_the_map} < rows
    assert sum("| proved |" in row for row in rows) == 24


def test_coarse_enclosures_of_shares_hold_those_of_the_page(claims):
    on_page = dict(
        re.findall(r"area that runs ([\w ]+)\. \| proved \| (between .*) \|", shown("claims"))
    )
    assert len(on_page) == 4
    for one in claims:
        if label := one.claim.claim.partition("runs ")[2].removesuffix("."):
            if label not in on_page:
                continue
            low, high, fine_low, fine_high = map(
                float, re.findall(r"\d\.\d+", one.statement + on_page[label])
            )
            assert low <= fine_low <= fine_high <= high


def test_the_map_is_covered_once_by_rectangles_of_one_pathway(claims):
    boxes, found = proofs.map_areas()
    area = (boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2])
    assert np.sum(area) == pytest.approx(0.020 * 0.030, rel=1e-12)
    inner = preset("paper-forward").cells[0]
    rng = np.random.default_rng(0)
    for k in rng.choice(np.flatnonzero(found >= 0), 30).tolist():
        left, right, bottom, top = boxes[k]
        outer = inner.with_anchors(q=(rng.uniform(left, right), rng.uniform(bottom, top)))
        cycle = sw.Chain([inner, outer]).cycle()
        assert cycle.pathway is list(Pathway)[int(found[k])]


@pytest.mark.parametrize("name", ROWS)
def test_the_page_has_what_is_proved_of_a_preset(name):
    assert SAMPLES == 1000
    assert margin_row(name, preset(name)) in shown("margins").splitlines()
    if not preset(name).elements:
        assert box_row(name, preset(name)) in shown("machines").splitlines()


def test_every_table_of_the_page_has_rows():
    presets = {row.split("|")[1] for row in shown().splitlines()}
    for name in TABLES:
        # The random chains are summed up by their number of cells and by what is not proved.
        assert len(shown(name).splitlines()) > (10 if name == "random chains" else 20)
        if name not in ("claims", "random chains"):
            assert {row.split("|")[1] for row in shown(name).splitlines()} == presets


def test_the_table_of_random_chains_is_that_of_their_record():
    assert shown("random chains") == random_chains()
