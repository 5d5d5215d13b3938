"""All files of a build, by name: drawings, meshes, sheets, coupon, template, lists, guide."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from stepwell.base import ByValue, InputError, Shows, need
from stepwell.build.builds import Build
from stepwell.build.exports.before import first_measurement
from stepwell.build.exports.coupon import coupon
from stepwell.build.exports.cutting import cutting
from stepwell.build.exports.dxf import Version, dxf_text
from stepwell.build.exports.guide import Guide, guide, guide_html, guide_pdf
from stepwell.build.exports.page import PAPERS, Page, pdf_bytes
from stepwell.build.exports.parts_list import bands_csv, parts_csv
from stepwell.build.exports.robot_guide import robot_guide
from stepwell.build.exports.sheets import CutSheet, sheets
from stepwell.build.exports.solids import mesh_of, step_bytes, stl_bytes, threemf_bytes
from stepwell.build.exports.svg import svg_text
from stepwell.build.exports.template import template_page, template_pages
from stepwell.build.robots.robot_builds import RobotBuild
from stepwell.design import BandType

DRAFT = "DRAFT"
Files = dict[str, str | bytes]


@dataclass(frozen=True, slots=True, eq=False)
class FileOptions(ByValue):
    """Which files are written, and how parts are nested.

    Args:
        dxf: "R2010", or "R12" for old programs.
        step: STEP files too; they need build123d.
        nest: time limit of the nesting of each material [s]; 0 sets parts in rows.
        seed: of the nesting.
        bands: available bands, such as measured ones; bands.csv names those that suit.
        draft: write files although findings are left; each name begins with DRAFT- and each file
            says so.
    """

    dxf: Version = "R2010"
    step: bool = False
    nest: float = 10.0
    seed: int = 0
    bands: tuple[BandType, ...] = ()
    draft: bool = False


def build_files(
    build: Build | RobotBuild, options: FileOptions | None = None, *, progress: Shows | None = None
) -> Mapping[str, str | bytes]:
    """Names and contents of all files of a build; `stepwell.reports.write` writes them.

    Args:
        build: parts, fasteners and bands.
        options: the usual ones by default.
        progress: called with the time spent on nesting and its limit [s].

    Raises:
        ValueError: findings are left and `options.draft` is not set, or a part is larger than the
            machine's bed or narrower than its kerf.
    """
    need("build")
    options = options or FileOptions()
    draft = _draft(build, options)
    parts, sheet = build.parts, build.build_file.sheet
    nested = sheets(parts, sheet.bed, seconds=options.nest, seed=options.seed, progress=progress)
    kerf = sheet.kerf_x, sheet.kerf_y
    files: Files = {}
    for part in parts:
        paths = cutting(part, kerf)
        title = _titled(part.name, draft)
        files[f"parts/{part.name}.dxf"] = _dxf(dxf_text(paths, options.dxf), draft)
        files[f"parts/{part.name}.svg"] = svg_text(cutting(part, kerf, marked=True), title)
        files[f"parts/{part.name}.stl"] = stl_bytes(mesh_of(part), title)
        if options.step:
            files[f"parts/{part.name}.step"] = step_bytes(part, title)
    for one in nested:
        files |= _sheet_files(one, kerf, options, draft)
    files |= _coupon_files(build, options, draft)
    files |= _template_files(build, draft)
    files["parts.csv"], files["bands.csv"] = (
        parts_csv(build, nested),
        bands_csv(build, options.bands),
    )
    content = _guide(build, nested, draft)
    files["guide.html"], files["guide.pdf"] = guide_html(content), guide_pdf(content)
    return dict(_named(files, draft))


def _guide(build: Build | RobotBuild, nested: tuple[CutSheet, ...], draft: str) -> Guide:
    if isinstance(build, RobotBuild):
        return robot_guide(build, nested, draft=draft)
    return guide(
        build.layout,
        nested,
        title=build.title,
        sequence=None if build.cycle is None else str(build.cycle.sequence),
        first=first_measurement(build.yield_),
        draft=draft,
    )


def _draft(build: Build | RobotBuild, options: FileOptions) -> str:
    """Why the files are a draft; empty if the build has no finding."""
    found = _reasons(build)
    if found and not options.draft:
        more = f" {len(found) - 1} more findings." if len(found) > 1 else ""
        raise InputError(
            f"nothing is written, for {len(found)} checks failed: {found[0]}{more} Change the "
            f"design or the build file, or write drafts with --draft (in Python draft=True)."
        )
    return found[0] if found else ""


def _reasons(build: Build | RobotBuild) -> list[str]:
    return [] if build.can_be_built else [*map(str, build.findings)] or ["parts collide"]


def draft_comment(build: Build | RobotBuild) -> str:
    """A line for the top of TOML files of a build that cannot be built; else empty."""
    return "".join(f"# {DRAFT}: {' '.join(why.split())}\n" for why in _reasons(build)[:1])


def _titled(title: str, draft: str) -> str:
    return f"{DRAFT} {title}" if draft else title


def _named(files: Files, draft: str) -> Iterator[tuple[str, str | bytes]]:
    """The files with names that say if they are drafts."""
    for name, content in files.items():
        folder, _, file = name.rpartition("/")
        file = f"{DRAFT}-{file}" if draft else file
        yield (f"{folder}/{file}" if folder else file), content


def _dxf(text: str, draft: str) -> str:
    """A comment in front of a DXF file; programs skip the group 999."""
    line = draft.replace("\n", " ")[:200].encode("ascii", "replace").decode("ascii")
    return f"999\n{DRAFT}: {line}\n{text}" if draft else text


def _sheet_files(
    one: CutSheet, kerf: tuple[float, float], options: FileOptions, draft: str
) -> Files:
    paths, name = one.cutting(kerf), f"sheets/{one.name}"
    title = _titled(f"sheet {one.name}", draft)
    return {
        f"{name}.dxf": _dxf(dxf_text(paths, options.dxf, layered=True), draft),
        f"{name}.svg": svg_text(paths, title),
        f"{name}.3mf": threemf_bytes(one.parts, one.places, title),
    }


def _coupon_files(build: Build | RobotBuild, options: FileOptions, draft: str) -> Files:
    sheet, pins = build.build_file.sheet, (build.build_file.pin, build.build_file.hook)
    made = coupon(sheet.material, sheet.thickness, tuple(one.diameter for one in pins))
    text = _dxf(dxf_text(made.cutting, options.dxf, layered=True), draft)
    reading = "\n".join(made.reading) + "\n"
    return {
        "coupon.dxf": text,
        "coupon.svg": svg_text(made.cutting, _titled("coupon", draft)),
        "coupon.txt": f"{DRAFT}\n{reading}" if draft else reading,
    }


def _template_files(build: Build | RobotBuild, draft: str) -> Files:
    parts = [part for part in build.parts if part.holes]
    title = _titled("Drilling template", draft)
    files: Files = {}
    for paper in PAPERS:
        pages = template_pages(parts, paper)
        for page in pages:
            _stamp(page, draft)
        files[f"template-{paper}.pdf"] = pdf_bytes(pages, title)
    for part in parts:
        page = template_page(part)
        _stamp(page, draft)
        files[f"template/{part.name}.svg"] = page.svg(f"{title}: {part.name}")
    return files


def _stamp(page: Page, draft: str) -> None:
    if draft:
        page.text((10.0, page.height - 7.0), f"{DRAFT}: {draft}", 2.6, bold=True, colour="#c00000")
