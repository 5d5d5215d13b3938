"""Notebooks show what a result is: a card for each, a figure where there is something to draw."""

import re
from dataclasses import is_dataclass, replace
from html.parser import HTMLParser
from importlib import import_module

import pytest
from matplotlib.figure import Figure

import stepwell as sw
from cards.values import every, of_chains
from stepwell import figures
from stepwell.accounts import card_of
from stepwell.accounts.kinds import ACCOUNTS as _CARDS
from stepwell.base import Drawn, InputError, Shown, brief, headed
from stepwell.figures.common.sheet import PageFigure
from stepwell.figures.defaults import _USUAL

ROOMS = "mechanism", "statics", "sequences", "design", "proof", "lab", "robot", "simulation"
# What is given, and what is told as a part of something else: these show what they print.
PARTS = {
    *("Accumulator", "AnchorBox", "AnchorMove", "AnchorPolygon", "Antenna", "Band", "Blocks"),
    *(
        "Body",
        "BodyMass",
        "RobotParts",
        "Shape",
        "Boundary",
        "Candidate",
        "CellReading",
        "Change",
        "Choice",
        "CopyNumber",
    ),
    *("Counting", "Critical", "Cubic", "Curve", "Cycles", "Cylinder", "Draws", "Drive"),
    *("DriveNeeds", "GaitComparison"),
    *("BehaviourRow", "Compiled", "CompiledDesign", "RobotBehaviour", "RobotChoice"),
    *("RowMargin", "RowTrial"),
    *("OtherLanding", "Estimate", "Fitted", "FittedParameter", "Flip", "Floor"),
    *("Foot", "ForceLaw", "Forgetting", "Goal", "HalfCycle", "History", "Hysteresis"),
    *("InertialLanding", "Latch", "Leg", "LegPrediction", "LibraryEntry", "Linear", "Load"),
    *("Loop", "MeasuredCurve", "MeasuredSnap", "Measurement", "Move", "Node"),
    *(
        "Observed",
        "Parameter",
        "ParameterEstimate",
        "Phase",
        "Prepared",
        "Push",
        "Reached",
        "Reading",
        "Refit",
        "Resistance",
        "ReturnPointMemory",
        "Rig",
        "Patch",
        "Plate",
        "Slope",
    ),
    *("HoleEvidence", "RequirementEvidence", "ScaleEvidence", "StateEvidence"),
    *("Episode", "Sample", "Scrambling", "Segment", "Sensitivities", "Series", "Settings"),
    *("Sheet", "SnapPrediction", "Sorted", "Step", "BandType", "Table", "Tie"),
    *("InertialPath", "Machine", "MachineDesign", "Requirement", "Requirements", "SafeRate"),
    "StrongestSnap",
    *("Tolerances", "Transition", "Trial", "Turn", "Wall", "Weighing", "WrongHole"),
    *("Actuator", "EnergyFlow", "HalvedStep", "Hop", "Impact", "JumpBound", "JumpSettings"),
    *("RecordFactor", "Release", "Springs", "WireSpring"),
    *("HopperParts", "ImpactLoad"),
    *("ProofGap", "ProvedChange", "ProvedEvent"),
}
VOID = {"img", "br"}
HOSTILE = '<script>alert("1")</script>&amp;\x1b[1m\u202e'


class Balanced(HTMLParser):
    """What is open, and every tag and attribute."""

    def __init__(self):
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, str]] = []

    def handle_starttag(self, tag, attrs):
        self.tags += [(tag, name) for name, _ in attrs] or [(tag, "")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def read(html: str) -> Balanced:
    page = Balanced()
    page.feed(html)
    assert page.open == []
    return page


def public() -> dict[str, type]:
    found = {}
    for room in ROOMS:
        offered = vars(import_module(f"stepwell.{room}"))
        names = import_module(f"stepwell.{room}").__dict__.get("__all__") or offered
        for name in names:
            if room == "proof" and name[0].islower():
                continue  # no class, and behind an extra
            value = getattr(import_module(f"stepwell.{room}"), name)
            if isinstance(value, type) and is_dataclass(value):
                found[value.__name__] = value
    return found


def test_every_public_value_has_a_card_of_its_own_or_is_a_part_of_another():
    neither = set(public()) - set(_CARDS) - PARTS
    assert neither == set()
    assert all(issubclass(value, Shown) for value in public().values())


@pytest.mark.slow
def test_no_card_and_no_figure_is_for_a_class_that_there_is_not():
    known = set(public()) | {type(value).__name__ for value in every().values()}
    assert set(_CARDS) | set(_USUAL) <= known


def test_a_class_has_plot_where_there_is_a_usual_figure_and_nowhere_else():
    drawn = {name for name, value in every().items() if isinstance(value, Drawn)}
    assert drawn == set(_USUAL)
    assert {name for name, value in public().items() if issubclass(value, Drawn)} <= drawn


@pytest.mark.slow
def test_every_card_and_every_figure_shows_in_a_notebook():
    values = every()
    # Proofs need an extra that a machine may lack.
    assert set(values) | {"PathProof", "ProvedRun"} == set(_CARDS)
    for name, value in values.items():
        html = value._repr_html_()
        read(html)
        assert not re.search(r"object at 0x|\b(nan|inf|None)\b", html), name
        if isinstance(value, Drawn):
            figure = value.plot()
            assert isinstance(figure, PageFigure), name
            page = read(figure._repr_html_())
            assert ("img", "alt") in page.tags and ("img", "width") in page.tags, name


def test_a_card_has_no_script_no_colour_of_text_and_fetches_nothing():
    for name, value in every().items():
        html = value._repr_html_()
        assert {tag for tag, _ in read(html).tags} <= {
            *("div", "strong", "table", "thead", "tbody", "tr", "th", "td")
        }, name
        # What sets no colour can be read on white and on black.
        assert ";color:" not in html and "url(" not in html and "http" not in html, name


def test_names_are_reported_letter_by_letter():
    chain = sw.preset("paper-forward")
    cells = [replace(cell, name=f"{HOSTILE}{i}") for i, cell in enumerate(chain.cells)]
    hostile = replace(chain, cells=cells, title=HOSTILE)
    for value in (hostile, hostile.cells[0], hostile.cycle(), hostile.graph(), hostile.margin()):
        html = value._repr_html_()
        read(html)
        assert "<script" not in html and "\x1b" not in html and "\u202e" not in html
        assert "&lt;script&gt;" in html and "&amp;amp;" in html


@pytest.mark.parametrize(
    ("heading", "said"),
    [
        ("cell", "Cell"),
        ("at state 0 [N]", "At state 0 [N]"),
        ("bands: anchors", "Bands: anchors"),
        ("p [mm]", "p [mm]"),
        ("d/u_max", "d/u_max"),
        ("foot.below_mm", "foot.below_mm"),
        ("leg.*.chain [mm]", "leg.*.chain [mm]"),
    ],
)
def test_a_word_at_the_head_of_a_column_has_a_capital_and_a_symbol_or_a_key_has_none(heading, said):
    assert headed(heading) == said


@pytest.mark.parametrize("cells", [1, 20])
def test_short_and_long_chains_have_cards_that_fit(cells):
    chain = sw.Chain(
        [sw.Cell(sw.Band((-0.01, 0.0), (0.01 + 1e-4 * k, 0.0), 28.5, 0.01)) for k in range(cells)]
    )
    for value in (chain, chain.cycle(), chain.cycle().path, chain.cycle().sequence):
        assert len(value._repr_html_()) < 14_000
    assert ("and 12 more of the cells" in chain._repr_html_()) == (cells == 20)


def test_what_has_no_usual_figure_says_what_has():
    with pytest.raises(InputError, match=r"Tolerances: has no default figure.*Cycle"):
        figures.plot(sw.Tolerances())
    assert "Anchors ±0 mm" in card_of(sw.Tolerances())


def test_a_map_shows_itself_and_another_dataset_says_that_it_is_none():
    view = of_chains()["MapView"]
    assert isinstance(figures.plot(view.dataset), Figure)
    with pytest.raises(InputError, match="is not a map"):
        view.dataset[["margin"]].assign_attrs(moved_cell=None).drop_attrs().stepwell.plot()


def test_what_results_print_has_no_more_digits_than_mean_something():
    chain = sw.preset("paper-forward")
    program = chain.program("01", start="10")
    assert repr(program.turns[0]).startswith("Turn(drive=0.03862, low=0.03723, high=0.04, ")
    assert "SNAP at 37.23 mm loading" in repr(chain.cycle().snaps[0])
    assert brief(chain.margin().changes[0]).count("0.") > 0
    for value in every().values():
        assert isinstance(value, dict) or len(repr(value)) < 1000, value
