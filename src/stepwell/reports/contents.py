"""Contents of the folder of each type of result."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import stepwell as sw
from stepwell import figures, mechanism
from stepwell.accounts import Account
from stepwell.base import InputError, have, write_netcdf
from stepwell.design import LONGEST_FOLLOWED, Margin, Yield, boundaries, transition_map
from stepwell.files import OUTPUTS, WrittenProgram, dumps, rig_toml, with_program
from stepwell.reports.write import Content, Contents, Draw, Progress, boundary_rows, design_text
from stepwell.studio import replay

if TYPE_CHECKING:
    from stepwell.build import Build, RobotBuild
    from stepwell.design import Check, Design, MapView, Reprogramming, Run, Survival, TappedDesign
    from stepwell.sequences import Realisation

# Nodes along an axis of a map, and its half width as a multiple of the margin.
_NODES, _BEYOND = 41, 1.35
# Samples that are drawn around the nominal design, and cells that fit into a figure.
_CLOUD, _DRAWABLE_CELLS = 600, 16
# Largest number of cells with an animation on the page.
MOST_PLAYED = 12
# Largest number of cells with legible graphs side by side.
_DRAWABLE_GRAPHS = 4
# Largest duration of a video; longer walks are played faster [s].
_LONGEST_VIDEO = 16.0
Warn = Callable[[str], object]


def _replay(played: Any, chain: sw.Chain, most: int, **how: Any) -> Callable[[], str] | None:
    return partial(replay, played, title=chain.title, **how) if len(chain) <= most else None


def _netcdf(result: Any) -> Callable[[Path], object]:
    return lambda file: write_netcdf(file, result.to_xarray())


def _run(run: Run, account: Account) -> Contents:
    draws = figures.standard_draws(run.cycle)
    draws = {name.replace("_", "-"): draw for name, draw in draws.items()} | _of_margin(run.margin)
    if run.built is not None:
        draws["yield"] = partial(figures.yield_bars, run.built)
    files = {"design.toml": design_text(account), "path.csv": run.cycle.path.to_csv}
    motion = _replay(run.cycle, run.chain, LONGEST_FOLLOWED, margin=run.margin)
    return Contents("run", "result.json", files, draws, motion=motion)


def _of_margin(margin: Margin) -> dict[str, Draw]:
    """Figures of a margin, and a map round the anchor with the smallest margin."""
    chain, draws = margin.chain, {"margins": partial(figures.margins, margin)}
    anchors = [change for change in margin.changes if change.parameter == "anchor"]
    nearest = min(anchors, key=lambda change: change.distance, default=None)
    # With the general engine a map takes seconds; a map of a long chain has too many regions.
    if nearest is None or margin.method != "exact" or len(chain) > LONGEST_FOLLOWED:
        return draws
    cell, far = chain.cells[nearest.cell], _BEYOND * nearest.distance
    # Maps need xarray.
    if not isinstance(cell, mechanism.Cell) or not 0.0 < far < math.inf or not have("tables"):
        return draws
    here = cell.bands[0].q
    x, y = (np.linspace(at - far, at + far, _NODES) for at in here)
    around = transition_map(chain, nearest.cell, x=x, y=y)
    curves = boundaries(chain, nearest.cell, x=x[[0, -1]], y=y[[0, -1]])
    draws["around"] = partial(figures.transition_map, around, curves, {"this design": here})
    return draws


def _program(program: sw.Program, account: Account) -> Contents:
    text, table, chain = account.about.design, WrittenProgram.of(program), program.chain
    written = with_program(text, table) if isinstance(text, str) else dumps(chain, program=table)
    files = {"design.toml": written, "program.csv": program.to_csv}
    draws = {"program": partial(figures.stroke_program, program)}
    motion = _replay(program, chain, LONGEST_FOLLOWED)
    return Contents("program", "program.json", files, draws, motion=motion)


def _map(view: MapView, account: Account) -> Contents:
    data, curves = view.dataset, view.boundaries
    ends = [(float(axis[0]), float(axis[-1])) for axis in (data["x"], data["y"])]
    inside = {
        name: place
        for name, place in view.designs.items()
        if all(low <= at <= high for (low, high), at in zip(ends, place, strict=True))
    }
    files = {"map.nc": partial(write_netcdf, data=data), "boundaries.csv": boundary_rows(curves)}
    draws = {"map": partial(figures.transition_map, data, curves, inside)}
    return Contents("map", "map.json", files, draws)


def _check(check: Check, account: Account) -> Contents:
    files, chain = {"design.toml": design_text(account)}, check.chain
    on_page = _of_yield(check.yield_) if isinstance(check.yield_, Yield) else {}
    motion = _replay(chain, chain, MOST_PLAYED)
    return Contents("check", "check.json", files, on_page=on_page, motion=motion)


def _build(
    made: Build | RobotBuild, account: Account, files: Mapping[str, str | bytes] | None = None
) -> Contents:
    """Contents of a build: `files` to cut and assemble it, the design and the build file."""
    from stepwell.build import RobotBuild, build_files, draft_comment, dumps_build_file

    draft = draft_comment(made)
    written: dict[str, Content] = {
        "design.toml": draft + design_text(account),
        "build.toml": draft + dumps_build_file(made.build_file),
        **(build_files(made) if files is None else files),
    }
    names = {*OUTPUTS["build"], *written}
    if isinstance(made, RobotBuild):
        parts: dict[str, Draw] = {"parts": partial(figures.robot_parts, made)}
        return Contents("build", "build.json", written, parts, names=names)
    layers: dict[str, Draw] = {"layers": partial(figures.layers, made)}
    motion = _replay(made.chain, made.chain, MOST_PLAYED)
    return Contents("build", "build.json", written, layers, motion=motion, names=names)


def _design(design: Design, account: Account) -> Contents:
    files = {"design.toml": design_text(account), "yield.csv": design.yield_.to_csv}
    draws = {"force-plane": partial(figures.plot, design)}
    if len(design.chain) <= MOST_PLAYED and not design.chain.elements:
        grid = design.holes
        drilled = () if grid is None else (grid.pitch, grid.origin)
        draws["holes"] = partial(figures.holes, design.chain, *drilled)
    return Contents("design", "design.json", files, draws)


def _tapped_design(made: TappedDesign, _account: Account) -> Contents:
    """Contents of a chain with two actuators: a design file for each side of the tap."""
    files: dict[str, Content] = {
        "design.toml": dumps(made.inner.chain),
        "beyond.toml": dumps(made.outer.chain),
    }
    return Contents("design", "design.json", files, names=(*OUTPUTS["design"], "beyond.toml"))


def _jump_design(made: sw.robot.JumpDesign, _account: Account) -> Contents:
    files: dict[str, Content] = {"design.toml": dumps(made.hopper), "yield.csv": made.yield_.to_csv}
    draws = {"holes": partial(figures.holes, made.hopper.chain, made.means.pitch)}
    return Contents("design", "design.json", files, draws)


def _reprogramming(result: Reprogramming, _account: Account) -> Contents:
    """Contents of a reprogramming: the changed design and the path to it."""
    files: dict[str, Content] = {}
    if result.chain_after is not None:
        files["design.toml"] = dumps(result.chain_after)
        if isinstance(result.displacement, tuple):
            files["way.csv"] = result.to_csv
    return Contents("reprogram", "reprogram.json", files)


def _yield(result: Yield, account: Account) -> Contents:
    files = {"design.toml": design_text(account), "yield.csv": result.to_csv}
    return Contents("yield", "yield.json", files, _of_yield(result))


def _realisation(_found: Realisation, account: Account) -> Contents:
    return Contents("program", "machine.json", {"design.toml": design_text(account)})


def _survival(_found: Survival, account: Account) -> Contents:
    return Contents("yield", "survival.json", {"design.toml": design_text(account)})


def _of_yield(result: Yield) -> dict[str, Draw]:
    draws: dict[str, Draw] = {"yield": partial(figures.yield_bars, result)}
    if len(result.chain) <= _DRAWABLE_CELLS:
        clouds = result.end_forces(_CLOUD)
        draws["force-plane"] = partial(figures.force_plane, result.chain, clouds=clouds)
    return draws


def _batch(batch: sw.lab.Batch, _: Account) -> Contents:
    recordings = batch.recordings
    files: dict[str, Content] = {
        "recordings.csv": partial(sw.lab.to_csv, recordings),
        "recordings.nc": lambda file: write_netcdf(file, sw.lab.table(recordings)),
    }
    if have("parquet"):
        files["recordings.parquet"] = partial(_parquet, recordings)
    draws = {"recordings": partial(figures.recordings, recordings)}
    return Contents("lab read", "recordings.json", files, draws)


def _parquet(recordings: Sequence[sw.lab.Recording], file: Path) -> None:
    """The tidy table of recordings with the columns of the CSV file."""
    import pyarrow as pa
    from pyarrow import parquet

    table = sw.lab.table(recordings)
    names = np.array([recording.name for recording in recordings])[table["of"].values]
    columns: dict[str, Any] = {"recording": names}
    for quantity in sw.lab.SAMPLE:
        columns[quantity.key] = table[quantity.name].values * quantity.factor
    parquet.write_table(pa.table(columns), file)


def _band(fit: sw.lab.BandFit, account: Account) -> Contents:
    draws = {"laws": partial(figures.band_laws, fit.test, fit.choice)}
    return Contents("lab band", "band.json", {"band.toml": account.record["table"]}, draws)


def _measured_element(measured: sw.lab.MeasuredElement, account: Account) -> Contents:
    draws = {"element": partial(figures.measured_element, measured)}
    files = {"design.toml": design_text(account), "element.csv": measured.to_csv}
    return Contents("lab element", "element.json", files, draws)


def _comparison(comparison: sw.lab.Comparison, _: Account) -> Contents:
    draws: dict[str, Draw] = {}
    if comparison.cells:
        draws["forces"] = partial(figures.measured_forces, comparison.cells)
        draws["energies"] = partial(figures.measured_energies, comparison.cells)
    if comparison.pairs:
        draws["pairs"] = partial(figures.measured_pairs, comparison.pairs)
    if comparison.chains:
        draws["chains"] = partial(figures.measured_pairs, comparison.chains)
    return Contents("lab compare", "compare.json", {"curves.csv": comparison.to_csv}, draws)


def _calibration(calibration: sw.lab.Calibration, account: Account) -> Contents:
    files: dict[str, Content] = {
        "band.toml": account.record["table"],
        "calibration.nc": _netcdf(calibration),
    }
    if calibration.pairs and not calibration.missing:
        files["pair.toml"] = dumps(calibration.pair())
        files["rig.toml"] = rig_toml(calibration.rig)
    draws = {"calibration": partial(figures.calibration, calibration)}
    return Contents("lab calibrate", "calibration.json", files, draws)


def _as_built(as_built: sw.lab.AsBuilt, _: Account) -> Contents:
    files: dict[str, Content] = {"built.toml": dumps(as_built.chain)}
    if as_built.moves:
        files["moved.toml"] = dumps(as_built.moves[0].of(as_built.chain))
    return Contents("lab as-built", "built.json", files)


def _copy_test(copy: sw.lab.CopyTest, account: Account) -> Contents:
    files: dict[str, Content] = {"design.toml": design_text(account)}
    return Contents("check", "check.json", {**files, "copy.toml": dumps(copy.chain)})


def _prediction(prediction: sw.robot.Prediction, account: Account) -> Contents:
    draws: dict[str, Draw] = {
        "robot": partial(figures.robot_drawing, prediction.robot),
        "prediction": partial(figures.prediction, prediction),
    }
    return Contents("robot show", "robot.json", {"robot.toml": design_text(account)}, draws)


def _simulated(
    result: sw.simulation.Walk | sw.simulation.Maze,
    account: Account,
    *,
    video: bool = False,
    view: str | tuple[float, float] | None = None,
    warn: Warn = warnings.warn,
) -> Contents:
    """Contents of a walk, on an empty floor or through an arena."""
    maze = isinstance(result, sw.simulation.Maze)
    walk, name = result.walk if maze else result, "maze" if maze else "walk"
    drawn = ("maze", "maze_timeline") if maze else ("trajectory", "gait", "contacts")
    arena = {"arena.toml": dumps(result.arena)} if maze else {}
    draws = {one.removeprefix("maze_"): partial(getattr(figures, one), result) for one in drawn}
    return Contents(
        name,
        f"{name}.json",
        {"robot.toml": design_text(account), **arena, "walk.nc": walk.to_netcdf},
        draws if len(walk.time) else {},
        motion=partial(replay, result),
        film=partial(_film, result, view, warn) if video else None,
    )


def _jump(
    jump: sw.simulation.Jump,
    account: Account,
    *,
    video: bool = False,
    view: str | tuple[float, float] | None = None,
    warn: Warn = warnings.warn,
) -> Contents:
    draws: dict[str, Draw] = {
        "energy-flow": partial(figures.energy_flow, jump),
        "flight": partial(figures.flight, jump),
    }
    files: dict[str, Content] = {"design.toml": design_text(account), "jump.csv": jump.to_csv}
    film = partial(_film_jump, jump, view, warn) if video else None
    return Contents("jump", "jump.json", files, draws, film=film)


def _film_jump(
    jump: sw.simulation.Jump,
    view: str | tuple[float, float] | None,
    warn: Warn,
    folder: Path,
    progress: Progress | None,
) -> None:
    targets = (folder / "jump.mp4", folder / "jump.gif")
    for some in (targets, targets[1:]):
        try:
            sw.simulation.jump_video(jump, *some, view=view or "side", progress=progress)
            return
        except ModuleNotFoundError as error:
            warn(str(error))
        except sw.simulation.VideoError as error:
            warn(str(error))
            return


def _compiled(
    result: sw.simulation.CompiledRobot,
    account: Account,
    parts: Mapping[str, str | bytes] | None = None,
) -> Contents:
    """Contents of a compiled behaviour: the table as given, the robot, and its `parts` if built."""
    files: dict[str, Content] = {"behaviour.toml": str(account.about.design or ""), **(parts or {})}
    draws: dict[str, Draw] = {}
    if result.design is not None:
        files["robot.toml"] = dumps(result.robot)
        draws["gait-plane"] = partial(figures.gait_plane, result)
        draws["robot"] = partial(figures.robot_drawing, result.robot)
    names = {*OUTPUTS["compile"], *files}
    return Contents("compile", "compile.json", files, draws, names=names)


def _sweep(sweep: sw.simulation.Sweep, _: Account) -> Contents:
    files: dict[str, Content] = {"sweep.csv": sweep.to_csv, "sweep.nc": _netcdf(sweep)}
    return Contents("robot sweep", "sweep.json", files, {"sweep": partial(figures.sweep, sweep)})


def _film(
    result: sw.simulation.Walk | sw.simulation.Maze,
    view: str | tuple[float, float] | None,
    warn: Warn,
    folder: Path,
    progress: Progress | None,
) -> None:
    maze = isinstance(result, sw.simulation.Maze)
    walk, name = result.walk if maze else result, "maze" if maze else "walk"
    if len(walk.time) < 2:
        return
    speed = max(1.0, float(walk.time[-1]) / _LONGEST_VIDEO)
    targets = (folder / f"{name}.mp4", folder / f"{name}.gif")
    for some in (targets, targets[1:]):
        try:
            how = {"speed": speed, "view": view, "progress": progress}
            sw.simulation.video(result, *some, **how)
            sw.simulation.picture(result, folder / "still.png", view=view)
            return
        except ModuleNotFoundError as error:  # an MP4 needs what a GIF does not
            warn(str(error))
        except sw.simulation.VideoError as error:
            # All other files of the folder are independent of the video.
            warn(str(error))
            return


def _study(status: sw.studies.Status, _: Account, partial: bool = False) -> Contents:
    """Contents of a study, without missing designs if `partial`; influences need 50 designs."""
    study = status.study
    if study.what == "atlas":
        raise InputError(f"{study.folder}: contains an atlas: use `stepwell atlas show`.")
    if not partial:
        study.require_whole()
    draws: dict[str, Draw] = {"outcomes": lambda **how: figures.outcomes(study, **how)}
    if status.decided:
        draws["influences"] = lambda **how: figures.influences(status.decided, **how)
    files: dict[str, Content] = {"study.csv": lambda file: study.to_csv(file, partial=partial)}
    return Contents("sweep report", "study.json", files, draws)


def _atlas(atlas: sw.studies.Atlas, _: Account) -> Contents:
    """Contents of an atlas: its transition graphs, if they are legible side by side."""
    drawable = atlas.graph_classes and len(atlas.chain) <= _DRAWABLE_GRAPHS
    draws: dict[str, Draw] = (
        {"graph_classes": partial(figures.graph_classes, atlas)} if drawable else {}
    )
    return Contents("atlas show", "atlas.json", draws=draws)


def _verdicts(verdicts: sw.paper.Verdicts, account: Account, **options: Any) -> Contents:
    # The claims of the paper are imported only for its figures.
    from stepwell.reports.paper import paper_contents

    return paper_contents(verdicts, account, **options)


# Functions that return the contents of a folder, by class of the result; called with the result and
# its account.
CONTENTS: dict[str, Callable[..., Contents]] = {
    "AsBuilt": _as_built,
    "CopyTest": _copy_test,
    "Atlas": _atlas,
    "BandFit": _band,
    "Batch": _batch,
    "Build": _build,
    "Calibration": _calibration,
    "Check": _check,
    "Comparison": _comparison,
    "CompiledRobot": _compiled,
    "Design": _design,
    "Jump": _jump,
    "JumpDesign": _jump_design,
    "MapView": _map,
    "Maze": _simulated,
    "MeasuredElement": _measured_element,
    "Prediction": _prediction,
    "Program": _program,
    "Realisation": _realisation,
    "Reprogramming": _reprogramming,
    "RobotBuild": _build,
    "Run": _run,
    "Status": _study,
    "TappedDesign": _tapped_design,
    "Survival": _survival,
    "Sweep": _sweep,
    "Verdicts": _verdicts,
    "Walk": _simulated,
    "Yield": _yield,
}
