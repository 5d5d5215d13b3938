"""`stepwell check` and `yield`: robustness of a design against manufacturing tolerances."""

from pathlib import Path
from typing import Any

import stepwell as sw
from stepwell.base import from_unit
from stepwell.cli import tolerances as given
from stepwell.cli.driving import program_in_file
from stepwell.cli.options import (
    Design,
    Display,
    Group,
    Output,
    Prove,
    Robust,
    by_name,
    flag,
    option,
    read_chain,
    read_design,
)
from stepwell.cli.ranges import length
from stepwell.cli.screen import answered, progress, usable, wrong
from stepwell.cli.tolerances import Data, calibrated_on


class MeasuredOptions(Group):
    """Recordings of cells, or of a built copy."""

    data: Data = None
    recording: Path | None = option(
        "Recording of a built copy (one file), both ways: judge this copy instead of the design.",
        "FILE",
        exists=True,
    )
    leg: str | None = option(
        "Leg of a robot whose recording is judged; the first one by default.", "NAME"
    )
    hole: float = option(
        "Spacing of the holes for anchors [mm], of which one may be wrong in a copy.",
        "--holes LENGTH",
        default=5.0,
        parser=length(0.1),
    )

    def chain(self, design: str) -> "tuple[str, sw.Chain]":
        """The text of a design, and its chain or that of a leg of its robot."""
        if self.recording is None:
            if self.leg is not None:
                raise wrong("--leg", "needs --recording FILE.")
            return read_chain(design)
        text, subject = read_design(by_name(design) or design)
        if isinstance(subject, sw.Chain):
            if self.leg is not None:
                raise wrong("--leg", f"{design} is a chain: leave it out.")
            return text, subject
        if self.leg is None:
            return text, subject.legs[0].chain
        with usable("--leg"):
            return text, subject.leg(self.leg).chain


def check(
    design: Design,
    target: str | None = option(
        "Target: a sequence such as 00>10>11>01>00; by default the program of the design, "
        "or the cycle of the nominal design.",
        "TARGET",
    ),
    *,
    within: given.BuildTolerances,
    measured: MeasuredOptions,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """Check robustness against manufacturing tolerances; verdict: robust, marginal or fails.

    The result contains the reason of the verdict, the smallest single change that breaks the
    target, actuator force and dissipated energy, warnings, and the measurement that would reduce
    the uncertainty most. If the verdict is "fails", the exit code is 3. With --out, a report and
    the result as JSON are written into a folder, together with the design.

    With --recording, a built copy of the design, or of a leg of a robot, is judged: its sequence,
    each switch and each part within the tolerances, the anchor in a wrong hole, and what to change.
    The verdict is good, differs, fails or not decided; unless it is good, the exit code is 3.

    Example: stepwell check preset:paper-forward --anchor 0.5
    """
    from stepwell.design import check

    text, chain = measured.chain(design)
    spread = within.of(chain)
    output.check_output_folder("check", design=text)
    if measured.recording is not None:
        _judge_copy((text, design, chain), measured, target, spread, sampling.seed, output)
        return
    calibrated = None
    if measured.data is not None:
        text, chain, spread, calibrated = calibrated_on(measured.data, text, chain, spread)
    file = sw.files.loads(text, design)
    goal = program_in_file(file) if target is None and file.program else target
    with usable(design), progress("check") as tell:
        result = check(chain, goal, spread, **vars(sampling), progress=tell)
    output.report(result, text, design, calibrated)
    answered(result.verdict != "fails")


def _judge_copy(
    given_design: "tuple[str, str, sw.Chain]",
    measured: MeasuredOptions,
    target: str | None,
    spread: Any,
    seed: int,
    output: Output,
) -> None:
    text, design, chain = given_design
    if measured.data is not None:
        raise wrong("--data", "cannot be combined with --recording.")
    assert measured.recording is not None
    with usable(str(measured.recording)):
        recording = sw.lab.read(measured.recording)
    with usable(design), progress("copy") as tell:
        hole = from_unit(measured.hole, "mm")
        how: dict[str, Any] = {"target": target, "hole": hole, "seed": seed}
        result = sw.lab.copy_test(chain, recording, spread, progress=tell, **how)
    output.report(result, text, design)
    answered(result.verdict == "good")


class CountedOptions(Group):
    """The target that samples have to reach."""

    target: str | None = option(
        "Target: a sequence such as 00>10>11>01>00, or the complete set of reachable states such "
        "as 00,10,11; the cycle of the nominal design by default.",
        "TARGET",
    )
    sensitivity: bool = flag("Compute the effect of each tolerance on the yield.", "--sensitivity")
    program: bool = flag(
        "Program of the design: count samples that it brings to its target state.", "--program"
    )
    robust: Robust = None

    def refuse_two(self) -> None:
        """Refuse options that exclude --program."""
        for name in ("target", "sensitivity", "robust"):
            if self.program and getattr(self, name):
                raise wrong(f"--{name}", "cannot be combined with --program.")


def yield_(
    design: Design,
    within: given.BuildTolerances,
    counted: CountedOptions,
    data: Data = None,
    *,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """Compute the fraction of samples that reach the target.

    The result contains the fraction with its 95 % interval, the outcomes of the other samples, and
    the pair of cells that fails first. With --out, figures, outcomes as CSV and the result as JSON
    are written into a folder, together with the design.

    Example: stepwell yield preset:paper-forward --samples 1000
    """
    from stepwell.design import survival, yields

    text, chain = read_chain(design)
    spread = within.of(chain)
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
            result = survival(played.chain, turns, played.target, spread, start=start, **how)
        else:
            asked: dict[str, Any] = {"sensitivity": counted.sensitivity, "robust": counted.robust}
            result = yields(chain, spread, target=states, **asked, **how)
    output.report(result, text, design, calibrated)


def margin(
    design: Design, within: given.BuildTolerances, prove: Prove = False, *, display: Display
) -> None:
    """Compute the margin: the smallest change of each parameter that changes the sequence.

    With --prove, the result contains a proof: no smaller change of one parameter changes the
    sequence, and every machine within the tolerances has it, or one machine that has not.

    Example: stepwell margin preset:paper-forward --prove --anchor 0.5
    """
    text, chain = read_chain(design)
    spread = within.of(chain)
    with usable(design), progress("margin") as tell:
        result: Any = chain.margin(progress=tell)
    if prove:
        with usable("--prove"), progress("proof") as tell:
            result = result.prove(spread, progress=tell)
    display.report(sw.accounts.account(result, sw.accounts.About(text, design)))
