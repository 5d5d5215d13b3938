"""The forms of an account as text, and chains of every shape that accounts know."""

import math
import re
from functools import cache
from html.parser import HTMLParser
from importlib import import_module

import numpy as np

import stepwell as sw
from sizes import SIZE
from stepwell.accounts import Account, card, page, terminal
from stepwell.base import Measure

# One shape in three measures: travels and forces by what makes SI of mm and N, mL and kPa, deg and
# mN m.
SCALES = {
    Measure.TRAVEL: (1e-3, 1.0),
    Measure.VOLUME: (1e-6, 1e3),
    Measure.ANGLE: (math.pi / 180, 1e-3),
}
# Chains of at most four cells: levers in closed form and by the engine, a tie, a program, elements;
# those of one shape and one actuator are alike.
QUICK = (
    *("paper-forward", "paper-cell-0-m15", "paper-forward-double", "paper-identical"),
    *("paper-via-10", "combination-lock", "compliant-actuator", "force-control", "friction"),
    *("rubber", "slack", "three-wave", "balloon"),
)
PRESETS = QUICK
if SIZE == "full":
    PRESETS = [
        name
        for name in sw.presets()
        if isinstance(sw.preset(name), sw.Chain) and len(sw.preset(name)) <= 4
    ]


def shown(found: Account) -> str:
    """What the terminal shows with --full."""
    return "\n".join(line.text for line in terminal(found, full=True))


def plain(html: str) -> str:
    """The words of HTML: without its tags and styles, with the minus and the arrows of JSON."""
    bare = re.sub(r"<style>.*?</style>|<[^>]*>", " ", html, flags=re.DOTALL)
    bare = bare.replace("&gt;", ">").replace(" → ", ">").replace("\N{MINUS SIGN}", "-")
    return bare.replace("&#x27;", "'").replace("&amp;", "&")


def forms(found: Account) -> tuple[str, str, str]:
    """What the terminal, the card and the page show, as words."""
    return shown(found).replace(" → ", ">"), plain(card(found)), plain(page(found))


class Tables(HTMLParser):
    """The tables of HTML as lists of rows of text."""

    def __init__(self, text: str):
        super().__init__()
        self.found: list[list[list[str]]] = []
        self.inside = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag == "table":
            self.found.append([])
        elif tag == "tr":
            self.found[-1].append([])
        elif tag in ("td", "th"):
            self.found[-1][-1].append("")
            self.inside = True

    def handle_endtag(self, tag):
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data):
        if self.inside:
            self.found[-1][-1][-1] += data.replace("\N{MINUS SIGN}", "-")


def pair(measure: Measure, stops: bool = False) -> sw.Chain:
    """A clockwise pair, of the same numbers in the units of any measure."""
    travel, force = SCALES[measure]
    cells = [
        sw.Element.from_points(
            [at * travel for at in (0.0, 10.0, 30.0, 50.0)],
            [at * force for at in (0.0, peak, -peak, 2.0)],
            name,
            stops=stops,
            measure=measure,
        )
        for name, peak in (("soft", 1.0), ("stiff", 1.2))
    ]
    return sw.Chain(cells, title="pair")


def folded() -> sw.Chain:
    """An element whose curve folds back."""
    travel = np.linspace(0.0, 5e-3, 200)
    force = np.interp(travel, [0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5])
    curve = (travel + force / 400).tolist(), force.tolist()
    return sw.Chain([sw.Element.from_curve(*curve, "folded")])


def mixed(**more) -> sw.Chain:
    """A cell with a lever, and an element."""
    dome = sw.Element.from_points([0, 5e-3, 13e-3, 20e-3], [0, 0.3, -0.3, 0.5], "dome")
    return sw.Chain([sw.preset("paper-forward").cells[0], dome], **more)


@cache
def shapes() -> dict[str, sw.Chain]:
    """A chain of every shape."""
    found = {f"{measure.name.lower()}s": pair(measure) for measure in Measure}
    found |= {"mixed": mixed(), "folded": folded()}
    found["mixed by force"] = mixed(actuator_stiffness=0.0)
    found["volumes by pressure"] = sw.Chain(pair(Measure.VOLUME).cells, actuator_stiffness=0.0)
    return found


SHAPES = list(shapes())


def refuse(*_: object, **__: object) -> None:
    """What stands in for an engine that must not be called."""
    raise AssertionError("an account calls the engine")


def sealed(monkeypatch) -> None:
    """Let nothing be computed of a chain from here on."""
    for name in ("path", "cycle", "margin", "program", "graph", "implicit_graph", "yields"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    for name in ("cycle", "margin", "yields"):
        monkeypatch.setattr(import_module("stepwell.design.run"), name, refuse)
    monkeypatch.setattr(import_module("stepwell.design.margins.margin"), "cycle", refuse)
    monkeypatch.setattr(sw.Path, "landings", refuse)
