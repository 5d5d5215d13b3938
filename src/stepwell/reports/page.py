"""One HTML page that tells what a design does, how sure that is and what it assumes."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING

from stepwell.base import __version__
from stepwell.mechanism import Chain, Linear
from stepwell.results import LONGEST_BECOMING, tie_notes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Margin
    from stepwell.sequences import Cycle
    from stepwell.statics import Event

# Longer tables help nobody; the path's CSV has everything.
_MOST_ROWS = 200
_LONGEST_SEQUENCE = 2000
_MINUS = "\N{MINUS SIGN}"


def report(
    cycle: Cycle,
    margin: Margin | None,
    figures: Mapping[str, Figure],
    source: str | None = None,
) -> str:
    """The results of one design as a self-contained page.

    Nothing in it is fetched or run: styles are inline, figures are embedded, there is no script.

    Args:
        cycle: what the design does.
        margin: how far it is from doing something else; None where that was not computed.
        figures: what to show, in this order, by caption.
        source: the design file's name, for the head of the page.

    Returns:
        HTML text.
    """
    chain = cycle.chain
    page = Template((files("stepwell.reports") / "report.html").read_text("utf-8"))
    origin = f"Design file {source}" if source else "A design made in Python"
    return page.substitute(
        version=escape(__version__),
        title=escape(chain.title or source or "Untitled chain"),
        origin=escape(f"{origin}. {_count(len(chain), 'cell')}, innermost first."),
        sequence=escape(_sequence(cycle).replace(">", " → ")),
        meaning=escape(_meaning(cycle)),
        numbers=_numbers(cycle, margin),
        warnings=_warnings(cycle),
        figures="\n".join(_figure(caption, figure) for caption, figure in figures.items()),
        cells=_cells(chain),
        events=_events(cycle),
        margin=_margin(chain, margin),
        assumptions="\n".join(f"<li>{escape(line)}</li>" for line in _assumptions(chain)),
    )


def _sequence(cycle: Cycle) -> str:
    sequence = cycle.sequence
    if len(sequence) * len(cycle.chain) <= _LONGEST_SEQUENCE:
        return str(sequence)
    return f"{len(sequence)} states of {len(cycle.chain)} cells"


def _meaning(cycle: Cycle) -> str:
    names = cycle.chain.names

    def order(cells: Iterable[int]) -> str:
        listed = [names[i] for i in cells]
        return ", ".join(listed[:12]) + (", …" if len(listed) > 12 else "")

    pathway = f"Pathway {cycle.pathway.label}. " if cycle.pathway is not None else ""
    return (
        f"{pathway}Cells load in the order {order(cycle.loading_order)}, and unload in the order "
        f"{order(cycle.unloading_order)}."
    )


def _numbers(cycle: Cycle, margin: Margin | None) -> str:
    found = [
        ("Snaps", str(len(cycle.snaps))),
        ("Peak actuator force", f"{_number(cycle.peak_force)} N"),
        ("Dissipated in a cycle", f"{_number(cycle.dissipated * 1e3)} mJ"),
        ("Full stroke", f"{_number(cycle.chain.full_stroke * 1e3)} mm"),
    ]
    if margin is not None:
        anchor = min(map(float, margin.anchors), default=math.inf)
        found.append(("Nearest other sequence", _distance(anchor, 1e3, "mm of an anchor")))
    return "\n".join(
        f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in found
    )


def _warnings(cycle: Cycle) -> str:
    if not cycle.degenerate:
        return ""
    notes = tie_notes(cycle.degenerate, cycle.chain)
    items = "".join(f"<li>{escape(text)}</li>" for text in notes)
    return (
        '<div class="warning" role="note"><strong>Too close to call.</strong> The model cannot '
        f"tell which of these happens; a real mechanism will decide.<ul>{items}</ul></div>"
    )


def _figure(caption: str, figure: Figure) -> str:
    from stepwell.figures import svg

    # An image, not inline markup: two SVGs on one page would share their ids.
    data = base64.b64encode(svg(figure).encode()).decode()
    width, height = (round(96 * inches) for inches in figure.get_size_inches())
    wide = ' class="wide"' if width > 400 else ""
    text = escape(caption)
    return (
        f'<figure{wide}><img alt="{text}" width="{width}" height="{height}" '
        f'src="data:image/svg+xml;base64,{data}"><figcaption>{text}</figcaption></figure>'
    )


def _cells(chain: Chain) -> str:
    rows: list[list[str]] = []
    for cell, name in zip(chain.cells, chain.names, strict=True):
        largest = max(band.stiffness for band in cell.bands) * cell.lever
        rows.append(
            [
                name,
                "; ".join(
                    f"p ({_number(b.p[0] * 1e3)}, {_number(b.p[1] * 1e3)}) mm, "
                    f"q ({_number(b.q[0] * 1e3)}, {_number(b.q[1] * 1e3)}) mm, "
                    f"{_number(b.stiffness)} N/m, {_number(b.rest_length * 1e3)} mm"
                    for b in cell.bands
                ),
                _number(cell.full_travel * 1e3),
                _number(cell.force_0),
                _number(cell.force_1),
                _number(cell.force_0 / largest),
                _number(cell.force_1 / largest),
                _number(math.degrees(cell.peak_angle)),
                "yes" if cell.is_bistable else "no",
            ]
        )
    head = [
        "Cell",
        "Bands: anchors, stiffness k, rest length",
        "Travel S [mm]",
        "F0 [N]",
        "F1 [N]",
        "F0/(kr)",
        "F1/(kr)",
        "θmax [°]",
        "Bistable",
    ]
    about = (
        "F0 and F1 are the forces along travel at state 0 and state 1, k the stiffness of the "
        "cell's stiffest band, r its lever, θmax where its energy peaks."
    )
    return _table(head, rows, about, left=(1,))


def _events(cycle: Cycle) -> str:
    names = cycle.chain.names

    def row(event: Event) -> list[str]:
        moves = ", ".join(
            f"{names[cell]} {_number(a * 1e3)} → {_number(b * 1e3)}" if a != b else names[cell]
            for cell, a, b in zip(event.cells, event.before, event.after, strict=True)
        )
        arrivals = ", ".join(f"{names[cell]} at {stop}" for cell, stop in event.arrivals)
        snap = event.kind.name == "SNAP"
        return [
            event.kind.name.lower(),
            "loading" if event.direction > 0 else "unloading",
            _number(event.stroke * 1e3, 6),
            moves if snap else arrivals,
            _number(event.force_before),
            _number(event.force_after),
            _number(event.released * 1e3) if snap else "",
            event.cause.value,
        ]

    head = [
        "Event",
        "While",
        "Stroke [mm]",
        "Cells [mm of travel]",
        "Force before [N]",
        "Force after [N]",
        "Released [mJ]",
        "Cause",
    ]
    about = (
        "A switch is a cell arriving at a stop; a snap is a jump that no stroke can stop. "
        "Strokes are exact, not read off a grid."
    )
    return _table(head, [row(event) for event in cycle.events], about, left=(1, 3, 7))


def _margin(chain: Chain, margin: Margin | None) -> str:
    if margin is None:
        return "<p>Not computed.</p>"
    spelled = len(chain) <= LONGEST_BECOMING
    rows: list[list[str]] = []
    for change in sorted(margin.changes, key=lambda change: change.distance):
        found = math.isfinite(change.distance)
        if isinstance(change.move, tuple):
            x, y = (_signed(part * 1e3) for part in change.move)
            distance = _distance(change.distance, 1e3, "mm")
            move = f"q by ({x}, {y}) mm" if found else ""
        else:
            distance = _distance(change.distance, 100.0, "%")
            move = f"k by {_signed(change.move * 100)} %" if found else ""
        if change.parameter == "anchor" and not found:
            distance = "none within reach"
        becomes = change.becomes if spelled else ""
        rows.append([chain.names[change.cell], change.parameter, distance, move, becomes])
        if len(rows) == _MOST_ROWS:
            break
    how = (
        "exact: every change is in closed form"
        if margin.method == "exact"
        else f"searched with the engine. {margin.resolution}"
    )
    gap = (
        f" The smallest gap between two F0 or two F1 is {_number(margin.gap)} times k r of the "
        f"innermost cell."
        if math.isfinite(margin.gap)
        else ""
    )
    about = (
        f"The smallest change of one thing at a time that gives another sequence ({how}); anchors "
        f"were moved by up to {_number(margin.reach * 1e3)} mm.{gap}"
    )
    head = ["Cell", "What", "How far", "Which way", "Sequence past it"]
    if not spelled:
        head, rows = head[:-1], [row[:-1] for row in rows]
    return _table(head, rows, about, left=(1, 3, 4), total=len(margin.changes))


def _assumptions(chain: Chain) -> list[str]:
    cells, names = chain.cells, chain.names
    stiffness = chain.actuator_stiffness
    if math.isinf(stiffness):
        actuator = "The actuator is rigid: it prescribes the stroke."
    elif stiffness == 0:
        actuator = "The actuator prescribes the force, not the stroke."
    else:
        actuator = f"The actuator has a stiffness of {_number(stiffness)} N/m in series."
    found = [
        "Quasi-static: the stroke changes slowly, inertia plays no part between snaps.",
        "Levers and blocks are rigid, joints have no play, and each cell stops where its blocks "
        "touch.",
        "After a snap the chain lands where overdamped flow at fixed drive leads it, every travel "
        "being equally mobile; the energy released is lost.",
        actuator,
    ]
    pushing = [
        n for cell, n in zip(cells, names, strict=True) if any(b.two_sided for b in cell.bands)
    ]
    if not pushing:
        found.append("Bands pull and never push: a slack band carries nothing.")
    elif len(pushing) == len(cells):
        found.append("Bands are two-sided springs, as in the paper: below rest length they push.")
    else:
        found.append(
            f"Bands of {_listed(pushing)} are two-sided springs that also push; the others pull "
            f"only."
        )
    curved = [
        n for cell, n in zip(cells, names, strict=True)
        if any(not isinstance(b.law, Linear) for b in cell.bands)
    ]  # fmt: skip
    found.append(
        f"Bands of {_listed(curved)} follow a nonlinear law; the others are linear."
        if curved and len(curved) < len(cells)
        else "Bands follow a nonlinear law."
        if curved
        else "Bands are linear: tension is stiffness times extension, without hysteresis."
    )
    rubbing = [
        f"{n} {_number(cell.friction)} N"
        for cell, n in zip(cells, names, strict=True)
        if cell.friction
    ]
    found.append(
        f"Coulomb friction against travel: {_listed(rubbing)}."
        if rubbing
        else "No friction between blocks."
    )
    loaded = [n for cell, n in zip(cells, names, strict=True) if cell.load is not None]
    found.append(
        f"A load that depends on its travel acts on {_listed(loaded)}."
        if loaded
        else "No weight or other load acts on a cell."
    )
    return found


def _table(
    head: list[str],
    rows: list[list[str]],
    about: str,
    *,
    left: tuple[int, ...] = (),
    total: int | None = None,
) -> str:
    total = len(rows) if total is None else total
    if total > _MOST_ROWS:
        about += f" The first {_MOST_ROWS} of {total} are shown."

    def line(tag: str, values: list[str], scope: str = "") -> str:
        made = (
            f"<{tag}{scope}{' class=left' if k in left else ''}>{escape(value)}</{tag}>"
            for k, value in enumerate(values)
        )
        return f"<tr>{''.join(made)}</tr>"

    body = "\n".join(line("td", row) for row in rows[:_MOST_ROWS])
    return (
        f'<div class="scroll"><table><caption>{escape(about)}</caption>'
        f"<thead>{line('th', head, ' scope=col')}</thead>\n<tbody>{body}</tbody></table></div>"
    )


def _number(value: float, digits: int = 4) -> str:
    # A rounding error is no sign: -0 and 1e-18 both print as 0.
    value = 0.0 if abs(value) < 1e-12 else value
    return f"{value:.{digits}g}".replace("-", _MINUS)


def _signed(value: float) -> str:
    return f"{value:+.4g}".replace("-", _MINUS)


def _distance(value: float, factor: float, unit: str) -> str:
    return f"{_number(value * factor)} {unit}" if math.isfinite(value) else "none within reach"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _listed(items: list[str]) -> str:
    return ", ".join(items[:12]) + (f" and {len(items) - 12} more" if len(items) > 12 else "")
