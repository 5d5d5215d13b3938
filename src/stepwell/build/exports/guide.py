"""The assembly guide: a picture for each step, and what to measure at the end; HTML and PDF."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple
from xml.sax.saxutils import escape

from stepwell.base import Vec2, grouped
from stepwell.build.contour import MM
from stepwell.build.exports.before import Expected, expected
from stepwell.build.exports.page import PAPERS, Page, Pen, broken, pdf_bytes, width_of
from stepwell.build.exports.picture import LIFT, NEW_METAL, NEW_PLATE, PLATE, ObliqueView
from stepwell.build.exports.sheets import MARGIN, CutSheet
from stepwell.build.exports.steps import AssemblyStep, steps_of
from stepwell.build.layouts import Layout
from stepwell.build.part import Part
from stepwell.build.plates import Fastener

# Edge of a page; size of a step's picture and of a sheet's map at most [mm].
_EDGE = 12.0
_PICTURE, _MAP = (186.0, 128.0), (186.0, 70.0)
# Width of a plate in plan at most [mm].
_PLAN = 84.0
_GREY, _RED = "#606060", "#c00000"
# The page loads nothing and runs nothing.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
_BEFORE = "Before you pull"
_INTRO = (
    "Measure the travels without bands, then hook the bands in and measure the rest. A kitchen "
    "scale at the drive shows grams."
)


class PicturedStep(NamedTuple):
    """A step with its pictures.

    Attributes:
        step: title, instruction and details.
        picture: of the assembly with the new items.
        maps: of the sheets with the new parts, or the new fasteners at full size; and captions.
    """

    step: AssemblyStep
    picture: Page
    maps: tuple[tuple[Page, str], ...]


class Guide(NamedTuple):
    """The content of an assembly guide.

    Attributes:
        title: of the mechanism.
        about: material, number of parts and fasteners.
        steps: from the lowest layer upwards.
        whole: the picture of the finished mechanism.
        checks: what to measure before the first pull.
        intro: what to read before measuring.
        marks: what the engraved marks mean.
        order: of the steps.
        lines: what lines in the pictures mean.
        draft: why it is a draft; empty if all checks passed.
    """

    title: str
    about: str
    steps: tuple[PicturedStep, ...]
    whole: Page
    checks: tuple[Expected, ...]
    intro: str
    draft: str
    marks: str = (
        "Marks are engraved: the number of the block with B, S or T for its bottom, spacer and top "
        "plate; the number of the cell on levers. Block 0 is the fixed one."
    )
    order: str = "from the lowest layer upwards"
    lines: str = "; dashed lines lead to their places"


def guide(
    layout: Layout,
    sheets: Sequence[CutSheet],
    *,
    title: str,
    sequence: str | None = None,
    first: str = "",
    draft: str = "",
) -> Guide:
    """The guide to assemble a layout.

    Args:
        layout: parts, fasteners and bands.
        sheets: on which the parts are cut.
        title: of the mechanism.
        sequence: of its states, such as "00>10>11>01>00", for the last page.
        first: the most useful measurement, a sentence.
        draft: why it is a draft, for every page; empty if it is none.
    """
    # All cells in state 0, as the mechanism lies on a table after it was pushed together.
    view = ObliqueView(layout, layout.angles("0" * len(layout.cells)), _PICTURE)
    before: list[object] = []
    shown = []
    for step in steps_of(layout):
        # Screws come from below, and the first plates lie on the table.
        lift = 0.0 if step.kind == "screw" or not before else LIFT
        picture = view.picture(before, step.new, lift)
        shown.append(PicturedStep(step, picture, tuple(_maps(step, layout, sheets))))
        before += [*step.new, *step.hidden]
    sheet = layout.build_file.sheet
    about = (
        f"{len(layout.parts)} parts of {MM * sheet.thickness:g} mm {sheet.material}, "
        f"{sum(one.use != 'head' for one in layout.fasteners)} fasteners, {len(layout.bands)} bands"
    )
    checks = tuple(expected(layout, sequence))
    intro = f"{_INTRO} {first}".rstrip()
    return Guide(title, about, tuple(shown), view.picture(before, ()), checks, intro, draft)


def _maps(step: AssemblyStep, layout: Layout, sheets: Sequence[CutSheet]) -> list[tuple[Page, str]]:
    """Where the new parts are on their sheets, or the new fasteners at full size."""
    names = {one.name for one in step.new if isinstance(one, Part)}
    maps = [
        (sheet_map(sheet, names), f"Lower left corner of sheet {sheet.name}")
        for sheet in sheets
        if names & {part.name for part in sheet.parts}
    ]
    sizes = {one.size: one for one in step.new if isinstance(one, Fastener)}
    if step.kind == "hook":
        maps += _hook_plans(layout, [one for one in step.new if isinstance(one, Fastener)])
    return maps + [(full_size(one), f"{size}, at full size") for size, one in sizes.items()]


def _hook_plans(layout: Layout, hooks: Sequence[Fastener]) -> Iterator[tuple[Page, str]]:
    """The plates from above, the holes of the hooks in colour with their names."""
    for block, same in grouped((one.block, one) for one in hooks).items():
        names = {one.name for one in same}
        for part in layout.parts:
            if layout.body[part.name] == ("block", block) and part.base == same[0].low:
                caption = f"{part.name} from above: {', '.join(sorted(names))}"
                yield _plan(part, names), caption


def _plan(part: Part, names: set[str]) -> Page:
    x0, y0, x1, y1 = (MM * one for one in part.outline.bounds)
    scale = min(1.0, _PLAN / (x1 - x0))
    page = Page(scale * (x1 - x0) + 1.0, scale * (y1 - y0) + 1.0)
    at = 0.5 - scale * x0, 0.5 - scale * y0
    page.contours([part.outline], at, Pen(PLATE.line, "#ffffff", 0.2), scale)
    for hole in part.holes:
        new = hole.name in names
        pen = Pen(NEW_METAL.line, NEW_METAL.side) if new else Pen(PLATE.line, None, 0.1)
        page.contours([hole.contour], at, pen, scale)
    for hole in part.holes:
        if hole.name in names:
            x, y = (a + MM * scale * b for a, b in zip(at, hole.centre, strict=True))
            _label(page, (x, y + 500.0 * scale * hole.diameter + 0.9), hole.name, "#ffffff")
    return page


def _label(page: Page, at: Vec2, text: str, behind: str) -> None:
    """A short bold text, centred above `at` [mm] on a ground of its own."""
    (x, y), half = at, width_of(text, 2.7, bold=True) / 2.0 + 0.4
    corners = [(x - half, y - 0.4), (x + half, y - 0.4), (x + half, y + 2.4), (x - half, y + 2.4)]
    page.line(corners, Pen(None, behind), closed=True)
    page.text(at, text, 2.7, anchor="middle", bold=True)


def sheet_map(sheet: CutSheet, names: set[str]) -> Page:
    """The used corner of a sheet, the parts of these names in colour."""
    placed = [
        (part, [one.moved(*place) for one in (part.outline, *part.openings)])
        for part, place in zip(sheet.parts, sheet.places, strict=True)
    ]
    boxes = [contours[0].bounds for _, contours in placed]
    used = [max(box[2] for box in boxes), max(box[3] for box in boxes)]
    width, height = (MM * min(a + MARGIN, b) for a, b in zip(used, sheet.bed, strict=True))
    scale = min(_MAP[0] / width, _MAP[1] / height, 1.0)
    page = Page(scale * width, scale * height)
    edge = [(0.0, page.height), (0.0, 0.0), (page.width, 0.0)]
    page.line(edge, Pen("#808080", None, 0.4))
    for part, contours in placed:
        paint = NEW_PLATE if part.name in names else PLATE
        page.contours(contours, (0.0, 0.0), Pen(paint.line, paint.top, 0.1), scale)
        if part.name in names and part.mark:
            x0, y0, x1, y1 = contours[0].bounds
            middle = 500.0 * scale * (x0 + x1), 500.0 * scale * (y0 + y1) - 1.0
            _label(page, middle, part.mark, NEW_PLATE.top)
    return page


def full_size(one: Fastener) -> Page:
    """A fastener from the side at full size: what lies on it is the right one."""
    length, diameter = MM * (one.high - one.low), MM * one.diameter
    flat = one.use in ("shim", "nut")
    page = Page(max(length, diameter) + 2.0, diameter + 2.0)
    pen = Pen(NEW_METAL.line, NEW_METAL.top, 0.2)
    if flat:
        page.circle((diameter / 2.0 + 1.0, diameter / 2.0 + 1.0), diameter / 2.0, pen)
    else:
        y0, y1 = 1.0, 1.0 + diameter
        x0, x1 = 1.0, 1.0 + length
        page.line([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], pen, closed=True)
    return page


def guide_pages(content: Guide, paper: str = "A4") -> list[Page]:
    """The pages of a guide: a title page, a page for each step, what to measure."""
    size, count = PAPERS[paper], len(content.steps)
    pages = [_title_page(content, size)]
    for number, shown in enumerate(content.steps, 1):
        page = _page(content, size, f"Step {number} of {count}: {shown.step.title}")
        width = page.width - 2.0 * _EDGE
        y = page.height - _EDGE - 16.0
        y = page.paragraph((_EDGE, y), shown.step.text, width, 4.0) - 1.0
        for line in shown.step.details:
            y = page.paragraph((_EDGE, y), line, width, 3.0, colour=_GREY)
        picture = shown.picture
        y -= picture.height + 4.0
        page.insert(picture, ((page.width - picture.width) / 2.0, y))
        left = _place_maps(page, shown.maps, y - 6.0)
        pages.append(page)
        while left:
            more = f"Step {number} of {count}: {shown.step.title}, continued"
            pages.append(_page(content, size, more))
            left = _place_maps(pages[-1], left, size[1] - _EDGE - 16.0)
    pages += _check_pages(content, size)
    for number, page in enumerate(pages, 1):
        at = page.width - _EDGE, _EDGE - 5.0
        page.text(at, f"{number} / {len(pages)}", 2.8, anchor="end", colour=_GREY)
    return pages


def guide_pdf(content: Guide, paper: str = "A4") -> bytes:
    """The guide as a PDF file."""
    return pdf_bytes(guide_pages(content, paper), f"Assembly of {content.title}")


def _page(content: Guide, size: Vec2, heading: str) -> Page:
    page = Page(*size)
    if content.draft:
        page.text((_EDGE, size[1] - 6.0), f"DRAFT: {content.draft}", 3.0, bold=True, colour=_RED)
    page.text((_EDGE, size[1] - _EDGE - 5.0), heading, 5.5, bold=True)
    return page


def _title_page(content: Guide, size: Vec2) -> Page:
    page = Page(*size)
    if content.draft:
        page.text((_EDGE, size[1] - 6.0), f"DRAFT: {content.draft}", 3.0, bold=True, colour=_RED)
    width, y = size[0] - 2.0 * _EDGE, size[1] - _EDGE - 12.0
    y = page.paragraph((_EDGE, y), content.title, width, 7.0, bold=True) - 2.0
    y = page.paragraph((_EDGE, y), content.about, width, 3.6, colour=_GREY) - 2.0
    y -= content.whole.height
    page.insert(content.whole, ((size[0] - content.whole.width) / 2.0, y))
    y -= 10.0
    for line in _how_to_read(content):
        y = page.paragraph((_EDGE, y), line, width, 3.6) - 1.0
    return page


def _how_to_read(content: Guide) -> tuple[str, ...]:
    return (
        "Cut the coupon first, and enter its kerf and fits in the build file: see coupon.txt.",
        f"Assembly in {len(content.steps)} steps, {content.order}. New parts are "
        f"orange, new fasteners blue, new bands red{content.lines}.",
        content.marks,
        f"Measure the values of the last page, \u201c{_BEFORE}\u201d, before the drive is pulled.",
    )


Maps = Sequence[tuple[Page, str]]


def _place_maps(page: Page, maps: Maps, top: float) -> Maps:
    """Small pictures in rows from `top` [mm] down, with captions; returns those without room."""
    x, y, tall = _EDGE, top, 0.0
    for i, (picture, caption) in enumerate(maps):
        width = max(picture.width, 40.0) + 8.0
        if x > _EDGE and x + width > page.width - _EDGE + 8.0:
            x, y, tall = _EDGE, y - tall - 8.0, 0.0
        lines = broken(caption, width - 4.0, 2.8)
        under = 3.9 * (len(lines) - 1) + 2.0
        if y - under - picture.height < _EDGE:
            return maps[i:]
        for j, line in enumerate(lines):
            page.text((x, y - 3.9 * j), line, 2.8, colour=_GREY)
        page.insert(picture, (x, y - under - picture.height))
        x, tall = x + width, max(tall, picture.height + under)
    return ()


_COLUMNS = (0.0, 66.0, 98.0, 122.0)  # left edges [mm]
_HEADS = ("What to measure", "Expected", "Tolerance", "If it is off")


def _check_pages(content: Guide, size: Vec2) -> list[Page]:
    """The table of values to measure, on as many pages as it needs."""
    pages: list[Page] = []
    total, y = size[0] - 2.0 * _EDGE, 0.0
    widths = [b - a - 3.0 for a, b in zip(_COLUMNS, (*_COLUMNS[1:], total), strict=True)]

    def add(row: Sequence[str], *, bold: bool = False) -> float:
        cells = [broken(w, room, 2.8, bold=bold) for w, room in zip(row, widths, strict=True)]
        for x, lines in zip(_COLUMNS, cells, strict=True):
            for i, line in enumerate(lines):
                pages[-1].text((_EDGE + x, y - 3.9 * i), line, 2.8, bold=bold)
        below = y - 3.9 * max(map(len, cells)) - 2.2
        ends = (_EDGE, below + 2.6), (_EDGE + total, below + 2.6)
        pages[-1].line(ends, Pen("#b0b0b0", None, 0.15))
        return below

    for check in content.checks:
        if not pages or y < _EDGE + 16.0:
            pages.append(_page(content, size, _BEFORE))
            y = size[1] - _EDGE - 16.0
            if len(pages) == 1:
                y = pages[0].paragraph((_EDGE, y), content.intro, total, 3.6) - 4.0
            y = add(_HEADS, bold=True)
        y = add(check)
    return pages


_STYLE = """
body { font: 16px/1.5 Verdana, DejaVu Sans, sans-serif; max-width: 56rem; margin: 2rem auto;
  padding: 0 1rem; color: #222; background: #fff }
h1 { font-size: 1.7rem } h2 { font-size: 1.25rem; margin-top: 2.5rem }
svg { max-width: 100%; height: auto } .about, li, figcaption { color: #555 }
.maps { display: flex; flex-wrap: wrap; gap: 1.5rem } figure { margin: 0 }
.draft { color: #c00000; font-weight: bold }
table { border-collapse: collapse; font-size: 0.9rem }
td, th { border-bottom: 1px solid #bbb; padding: 0.4rem 0.8rem 0.4rem 0; text-align: left;
  vertical-align: top }
@media print { section { break-before: page } }
"""


def guide_html(content: Guide) -> str:
    """The guide as one HTML file, without scripts and without links to other files."""
    count = len(content.steps)
    draft = f'<p class="draft">DRAFT: {escape(content.draft)}</p>' if content.draft else ""
    title = f"Assembly of {content.title}"
    rows = [
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">',
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body><main>",
        f"{draft}<h1>{escape(content.title)}</h1><p class='about'>{escape(content.about)}</p>",
        _svg(content.whole, "The assembled mechanism"),
        *(f"<p>{escape(line)}</p>" for line in _how_to_read(content)),
    ]
    for number, shown in enumerate(content.steps, 1):
        heading = f"Step {number} of {count}: {shown.step.title}"
        rows.append(f"<section>{draft}<h2>{escape(heading)}</h2><p>{escape(shown.step.text)}</p>")
        if shown.step.details:
            lines = "".join(f"<li>{escape(line)}</li>" for line in shown.step.details)
            rows.append(f"<ul>{lines}</ul>")
        rows.append(_svg(shown.picture, shown.step.text))
        maps = "".join(
            f"<figure>{_svg(page, caption)}<figcaption>{escape(caption)}</figcaption></figure>"
            for page, caption in shown.maps
        )
        rows.append(f'<div class="maps">{maps}</div></section>')
    rows.append(
        f"<section>{draft}<h2>{_BEFORE}</h2><p>{escape(content.intro)}</p><table><thead><tr>"
    )
    rows += [f'<th scope="col">{head}</th>' for head in _HEADS]
    rows.append("</tr></thead><tbody>")
    for check in content.checks:
        rows.append(f"<tr>{''.join(f'<td>{escape(word)}</td>' for word in check)}</tr>")
    rows.append("</tbody></table></section></main></body></html>")
    return "\n".join(rows) + "\n"


def _svg(page: Page, title: str) -> str:
    """A picture within a page of HTML, named for readers that do not see it."""
    head, _, rest = page.svg(title).partition(">")
    return f'{head} role="img">{rest.strip()}'
