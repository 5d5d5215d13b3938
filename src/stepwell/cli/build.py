"""`stepwell build`: from a design to parts, drawings and an assembly guide."""

from dataclasses import replace
from typing import Any

import stepwell as sw
from stepwell.cli.design import bands_of
from stepwell.cli.options import Design, Group, Output, flag, option, read_buildable
from stepwell.cli.screen import answered, progress, usable, warn, wrong
from stepwell.cli.tolerances import BUILD_FILE, materials


class FileChoice(Group):
    """Which files are written."""

    nest: float = option(
        "Time limit of the nesting on sheets [s]; 0 sets the parts in rows.",
        "SECONDS",
        default=10.0,
        min=0,
        max=600,
    )
    bands: list[str] | None = option(
        "Available band, named in bands.csv if its forces are those of the design: paper, robot or "
        "antennas; stiffness [N/m] and rest length; or band.toml of lab band. May be repeated.",
        "--band NAME|K:LENGTH[:PERCENT]",
    )
    r12: bool = flag("Write DXF files of the old release R12.", "--r12")
    step: bool = flag("Write STEP files too; they need the extra `step`.", "--step")
    draft: bool = flag("Write files although checks failed; each says DRAFT.", "--draft")


def _named(band: Any, text: str) -> Any:
    """A type of band with a name for lists: its own, or what was given for it."""
    return band if band.name else replace(band, name=text)


def build(
    design: Design,
    material: str = option(
        "Build file (TOML), or the name of a preset: acrylic-3mm, plywood-3mm, pla-3mm.",
        f"--material {BUILD_FILE}",
        default="acrylic-3mm",
        autocompletion=materials,
    ),
    samples: int | None = option(
        "Number of Monte Carlo samples, for the yield of a chain.", "N", min=1, show_default="2000"
    ),
    target: str | None = option(
        "Target: a sequence such as 00>10>11>01>00, for the yield; the cycle of the nominal "
        "design by default.",
        "TARGET",
    ),
    *,
    choice: FileChoice,
    output: Output,
) -> None:
    """Compute the solid parts of a design, and check that they move free of each other.

    The design is a chain, a hopper, or a robot of two legs. The result contains the sweep over all
    angles, exceeded limits with a way out, masses, bands with their hooks; of a chain the yield
    within the errors of the build file, of a hopper also frame, foot bar and sole, and what its
    impacts ask of the parts; of a robot its shortest period. With --out, drawings (DXF, SVG),
    meshes (STL, 3MF), nested sheets, coupon, drilling template, parts list and assembly guide are
    written into a folder. If the design cannot be built, nothing is written without --draft and
    the exit code is 3.

    Example: stepwell build preset:paper-forward --out parts
    """
    from stepwell.build import FileOptions, build, build_files, load_build_file

    if choice.step:
        sw.base.need("step")
    bands = [_named(band, text) for text in choice.bands or () for band in bands_of(text)]
    text, subject = read_buildable(design)
    output.check_output_folder("build", design=text)
    with usable("--material"):
        build_file = load_build_file(material)
    more: dict[str, Any] = {} if samples is None else {"samples": samples}
    if target is not None:
        more["target"] = target
    if more and isinstance(subject, sw.robot.Robot):
        raise wrong(f"--{next(iter(more))}", "is for the yield of a chain: omit it for a robot.")
    with usable(design), progress("sweep") as tell:
        made = build(subject, build_file, progress=tell, **more)
    possible = made.can_be_built
    if output.out is not None and not possible and not choice.draft:
        warn(f"{output.out}: nothing is written, because checks failed; --draft writes drafts.")
        output = replace(output, out=None)
    how: dict[str, Any] = {}
    if output.out is not None:
        version = "R12" if choice.r12 else "R2010"
        options = FileOptions(
            version, choice.step, choice.nest, bands=tuple(bands), draft=choice.draft
        )
        with usable(design), progress("nesting") as tell:
            how["files"] = build_files(made, options, progress=tell)
    output.report(made, text, design, how=how)
    answered(possible)
