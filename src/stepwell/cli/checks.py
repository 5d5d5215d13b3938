"""`stepwell check` and `yield`: how a design does when it is made, within tolerances."""

from typing import Any

import stepwell as sw
from stepwell.cli import tolerances as given
from stepwell.cli.driving import program_in_file
from stepwell.cli.options import Design, Group, Output, Robust, flag, option, read_chain
from stepwell.cli.screen import answered, progress, usable, wrong
from stepwell.cli.tolerances import Data, calibrated_on


def check(
    design: Design,
    target: str | None = option(
        "The cycle that counts, as 00>10>11>01>00; by default the design's own program, "
        "or without one the cycle of the drawing.",
        "SEQUENCE",
    ),
    *,
    within: given.ToleranceOptions,
    data: Data = None,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """Check a design within tolerances: works, fragile or won't.

    You get the verdict with its reason, the smallest single change that breaks it, the pull and
    the energy lost, what is out of the ordinary, and which one measurement would make it surer.
    Where it won't, the exit code is 3. With --out, a report and the result as JSON are written
    into a folder, together with the design.

    Example: stepwell check preset:paper-forward --anchor 0.5
    """
    from stepwell.design import check

    text, chain = read_chain(design)
    spread = within.tolerances(chain.measure)
    output.check_output_folder("check", design=text)
    calibrated = None
    if data is not None:
        text, chain, spread, calibrated = calibrated_on(data, text, chain, spread)
    file = sw.files.loads(text, design)
    wanted = program_in_file(file) if target is None and file.program else target
    with usable(design), progress("check") as tell:
        found = check(chain, wanted, spread, **vars(sampling), progress=tell)
    output.report(found, text, design, calibrated)
    answered(found.verdict != "won't")


class CountedOptions(Group):
    """Which mechanisms count as working."""

    target: str | None = option(
        "The cycle that counts, as 00>10>11>01>00, or states that shall be in reach and "
        "no others, as 00,10,11; the cycle of the drawing by default.",
        "TARGET",
    )
    sensitivity: bool = flag("Compute how much each part's tolerance counts.", "--sensitivity")
    program: bool = flag(
        "Count those that the design's own program brings where it should.", "--program"
    )
    robust: Robust = None

    def refuse_two(self) -> None:
        """Refuse other options beside --program."""
        for name in ("target", "sensitivity", "robust"):
            if self.program and getattr(self, name):
                raise wrong(f"--{name}", "cannot stand with --program.")


def yield_(
    design: Design,
    within: given.ToleranceOptions,
    counted: CountedOptions,
    data: Data = None,
    *,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """Compute the fraction of samples that reach the target.

    Mechanisms are sampled at random and judged one by one; you get the fraction with its 95 %
    interval, what the others do, and the two cells that go wrong first. With --out, figures,
    outcomes as CSV and the result as JSON are written into a folder, together with the design.

    Example: stepwell yield preset:paper-forward --samples 1000
    """
    from stepwell.design import survival, yields

    text, chain = read_chain(design)
    spread = within.tolerances(chain.measure)
    output.check_output_folder("yield", design=text)
    counted.refuse_two()
    calibrated = None
    if data is not None:
        text, chain, spread, calibrated = calibrated_on(data, text, chain, spread)
    played = program_in_file(sw.files.loads(text, design)) if counted.program else None
    target = counted.target
    states = target.split(",") if target and "," in target else target
    with usable(design), progress("yield") as tell:
        how: dict[str, Any] = {**vars(sampling), "progress": tell}
        if played is not None:
            turns, start = played.turning_points, played.start
            found = survival(played.chain, turns, played.target, spread, start=start, **how)
        else:
            asked: dict[str, Any] = {"sensitivity": counted.sensitivity, "robust": counted.robust}
            found = yields(chain, spread, target=states, **asked, **how)
    output.report(found, text, design, calibrated)
