"""The committed claims say what the model computes today.

All claims are computed once, here; other files ask the committed ones.
"""

import json
import re
import subprocess
import sys

import pytest

from claims import CLAIMS, ROOT, assert_committed, committed, same
from facts import refuses
from sizes import SIZE
from stepwell import paper
from stepwell.accounts import account
from stepwell.paper import Judgement, Verdicts, measured as _measured, steering
from stepwell.paper.claims import BEGIN, END, replaced
from stepwell.paper.walking import WALKING_CLAIMS as ROBOT

# Written by commands of their own: from recordings, from many simulated runs, of others.
APART = ("measured.md", "many-runs.md", "others.md")
PAGES = [
    page
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
    if BEGIN in page.read_text("utf-8") and page.name not in APART
]


# Half a minute: chains that go back the way they came, as long as those that are brought to every
# state; what an antenna does with other numbers of bands, and our own, whose way past the cylinder
# tests/cli and tests/golden follow.
LONG = ("more-cells-sequenced", "antennas-paper-numbers", "antennas-turn-away")


@pytest.fixture(scope="module")
def computed() -> dict[str, paper.ClaimVerdict]:
    """Every claim judged anew, in the quick size but those for which another of its kind stands."""
    known = {verdict.claim.id: verdict for verdict in committed()}
    return {
        claim.id: known[claim.id] if SIZE == "ci" and claim.id in LONG else claim.judge()
        for claim in paper.claims()
    }


def test_the_comparison_sees_a_changed_number_and_a_changed_word():
    assert same("2.77 and -0.967 mm", "2.771 and -0.967 mm")
    assert not same("2.77 mm", "2.79 mm")
    assert not same("17 of 1315 snaps", "18 of 1315 snaps")
    assert not same("00>10>11>01>00", "00>01>11>10>00")
    assert not same("3 agree", "3 differ")


@pytest.mark.slow
@pytest.mark.shown
def test_the_committed_claims_are_those_computed_now(computed):
    assert_committed(CLAIMS, account(Verdicts(computed.values())).record)


@pytest.mark.slow
def test_what_differs_and_what_needs_data_is_known_and_has_its_reason(computed):
    differing = {name for name, v in computed.items() if v.verdict is Judgement.DIFFERS}
    assert differing == {"large-qx-directed", "eq-5-sign", "anchor-unit", "robot-forward-loss"}
    open_ = {name for name, v in computed.items() if v.verdict is Judgement.UNDETERMINED}
    assert open_ == {"antennas-bench-14", "antennas-bench-20", "antennas-paper-numbers"}
    lacking = {name for name, v in computed.items() if v.verdict is Judgement.NEEDS_DATA}
    assert lacking == set(_measured.IDS)
    assert all(computed[name].reason for name in differing | open_ | lacking)


@pytest.mark.slow
@pytest.mark.parametrize("claim", ROBOT, ids=lambda claim: claim.id)
def test_a_robot_claim_agrees(claim, computed):
    assert computed[claim.id].verdict is Judgement.AGREES


@pytest.mark.slow
def test_the_number_of_bands_decides_whether_the_papers_antenna_turns_a_step_round(computed):
    verdict = computed["antennas-paper-numbers"]
    assert verdict.verdict is Judgement.UNDETERMINED
    assert "00>10>11>01>00 with one band" in verdict.ours
    assert verdict.ours.endswith("00>01>11>10>00 with two bands")
    # Walks as far as the paper's robot and turns as much as one with a backward leg.
    walks, turns = re.findall(
        r"walks (\S+) u_max forward and, pressed, turns (\d+)°", verdict.reason
    )[0]
    assert float(walks) == pytest.approx(0.71, abs=0.08)
    assert float(turns) == pytest.approx(15.0, abs=2.5)


@pytest.mark.slow
def test_our_antennas_turn_the_opposite_step_round(computed):
    verdict = computed["antennas-turn-away"]
    assert verdict.verdict is Judgement.AGREES
    # What an antenna really moves is said, and it is less than half of what it could.
    assert "4.1 mm" in verdict.reason


def test_the_claims_page_shows_them():
    assert ROOT / "docs" / "claims.md" in PAGES


def test_the_page_of_many_runs_shows_its_file_and_names_every_claim():
    committed = json.loads((ROOT / "docs" / "many-runs.json").read_text("utf-8"))["claims"]
    assert [claim["id"] for claim in committed] == [claim.id for claim in steering.MANY_RUNS]
    page = (ROOT / "docs" / "many-runs.md").read_text("utf-8")
    for claim in committed:
        row = " | ".join(claim[key] for key in ("claim", "where", "paper", "ours", "tolerance"))
        assert f"| {row} | **{claim['verdict']}** |" in page


@pytest.mark.slow
@pytest.mark.shown
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_with_the_table_shows_what_is_computed_now(page, computed):
    text = page.read_text("utf-8")
    assert same(text, replaced(text, paper.markdown(computed.values())))


@pytest.mark.slow
def test_the_page_of_the_recordings_shows_what_they_give_now(kamp2024):
    asked = (claim for claim in paper.claims(kamp2024) if claim.id in _measured.IDS)
    verdicts = Verdicts(claim.judge() for claim in asked)
    page = (ROOT / "docs" / "measured.md").read_text("utf-8")
    assert same(page, replaced(page, paper.markdown(verdicts)))
    committed = json.loads((ROOT / "docs" / "measured.json").read_text("utf-8"))["claims"]
    computed = json.loads(json.dumps(account(verdicts).record["claims"]))
    assert len(committed) == len(computed) == len(_measured.IDS)
    for old, new in zip(committed, computed, strict=True):
        assert all(same(old[name], new[name]) for name in new), (old, new)


def test_the_page_of_the_recordings_holds_the_claims_that_need_them(verdicts):
    lacking = [v.claim.claim for v in verdicts if v.verdict is paper.Judgement.NEEDS_DATA]
    page = (ROOT / "docs" / "measured.md").read_text("utf-8")
    assert len(lacking) == len(_measured.IDS)
    assert all(claim in page for claim in lacking)


def test_writing_the_table_again_changes_nothing_and_keeps_the_rest():
    page = f"before\n{BEGIN}\nold\n{END}\nafter\n"
    once = replaced(page, "new")
    assert replaced(once, "new") == once
    assert once.startswith("before\n")
    assert once.endswith("\nafter\n")
    assert "old" not in once


@pytest.mark.parametrize("page", ["", BEGIN, END])
def test_a_page_without_its_markers_is_refused(page):
    with refuses(ValueError, "no place", "claims") as refused:
        replaced(page, "new")
    assert BEGIN in str(refused.value) and END in str(refused.value)


def test_a_bar_in_a_claim_does_not_break_the_table(verdicts):
    rows = paper.markdown(verdicts).split("\n\n")[0].splitlines()
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {7}
    assert len(rows) == 2 + len(verdicts)


@pytest.mark.slow
def test_the_module_says_how_to_be_called():
    tool = ROOT / "tests" / "docs" / "claims_pages.py"
    asked = subprocess.run([sys.executable, tool], capture_output=True, text=True, check=False)
    assert asked.returncode == 1
    assert asked.stderr.startswith(
        "usage:\npython tests/docs/claims_pages.py [--data PATH | --all | --others] FILE.json"
    )
