"""Run a study: compute the missing chunks of its store in parallel."""

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from stepwell.base import ByValue, InputError, Progress, Shown, StepwellError, notify
from stepwell.kernels import cores
from stepwell.studies.designs import Designs, Subject
from stepwell.studies.fill import fill
from stepwell.studies.found import (
    Extent,
    Frequency,
    OutcomeInterval,
    Varied,
    extents,
    frequencies,
    intervals,
    varied,
)
from stepwell.studies.influence import DecidingNumbers, decided
from stepwell.studies.mapper import WorkerError, mapped, mapped_on
from stepwell.studies.screen import Screened, aimed, screened
from stepwell.studies.store import PROBLEM, Gap, Study, StudyError, begun, opened
from stepwell.studies.work import WARP

# Default size of a chunk (some seconds of work), and largest number of chunks.
_CHUNK, _MOST_CHUNKS = 64, 10_000
_CHUNKS_OF = {"walk": 16, "maze": 1}
_WORLDS = 256
_CANCELLED = ".cancelled"


class SweepError(StepwellError, RuntimeError):
    """A study that could not be finished; finished chunks are kept."""


class CancelledError(SweepError):
    """A cancelled study; finished chunks are kept."""


@dataclass(frozen=True, eq=False)
class Status(ByValue, Shown):
    """Progress of a study, and its results so far.

    Attributes:
        study: the study.
        done: number of finished chunks.
        gaps: missing designs.
        problems: number of failed designs by the kind of their problem.
    """

    study: Study
    done: int
    problems: dict[str, int]
    gaps: tuple[Gap, ...] = ()

    @property
    def finished(self) -> bool:
        """Whether all chunks are finished."""
        return self.done == self.study.chunks

    @cached_property
    def varied(self) -> tuple[Varied, ...]:
        """The varied parameters with their ranges."""
        return varied(self.study)

    @cached_property
    def outcomes(self) -> tuple[Frequency, ...]:
        """Frequencies of the outcomes in every column of words, the most frequent first."""
        return frequencies(self.study)

    @cached_property
    def numbers(self) -> tuple[Extent, ...]:
        """The range of every result that is a number."""
        return extents(self.study)

    @cached_property
    def intervals(self) -> tuple[OutcomeInterval, ...]:
        """Intervals of equal outcomes along the only varied parameter, see `studies.intervals`."""
        return intervals(self.study)

    @cached_property
    def decided(self) -> tuple[DecidingNumbers, ...]:
        """First-order influences of the parameters, see `studies.decided`."""
        return decided(self.study)

    @cached_property
    def screened(self) -> Screened | None:
        """Agreement of a screen with the results, see `studies.screened`."""
        return screened(self.study)

    def __repr__(self):
        failed = sum(self.problems.values())
        return (
            f"Status({self.done} of {self.study.chunks} chunks done, "
            f"{failed} of {self.study.count} designs with a problem)"
        )


def sweep(
    design: Subject,
    what: str,
    designs: Designs,
    folder: str | os.PathLike[str],
    *,
    given: Mapping[str, Any] | None = None,
    chunk: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = None,
) -> Status:
    """Run a parameter study in parallel, with results in a resumable Zarr store.

    A call with the same arguments computes what is missing; after any interruption the finished
    store is bit-identical.

    Args:
        design: nominal chain or robot.
        what: quantity to compute: "cycle", "margin", "yield", "graph" or "program" for chains,
            "walk" or "maze" for robots, "call" for both.
        designs: a `Space` of parameters, a `Workshop` (Monte Carlo), or a `ListedDesigns`.
        folder: path of the store, which xarray opens as Zarr.
        given: options of `what`, see `work_of`.
        chunk: designs that are computed and written together; by default 64, or more if the study
            has more than 640,000; 16 walks, 1 maze, 256 screened robots.
        workers: number of processes; by default one per core. 0 computes in this process, which
            needs no `if __name__ == "__main__":` in a script.
        scheduler: address of a running Dask scheduler to use instead. Its workers must see the
            folder under the same path and have this version of Stepwell.
        progress: called with (done, total) chunks.

    Raises:
        ValueError: a parameter that the design does not have, or an unknown `what`.
        StudyError: the folder contains another study, or one of another version.
        SweepError: chunks could not be computed or written; the text contains the reason.
        ExtraError: the extra studies, or for a scheduler the extra cluster, is not installed.
    """
    study = planned_study(design, what, designs, folder, given=given, chunk=chunk)
    return resumed(begun(study), workers, scheduler=scheduler, progress=progress)


def planned_study(
    design: Subject,
    what: str,
    designs: Designs,
    folder: str | os.PathLike[str],
    *,
    given: Mapping[str, Any] | None = None,
    chunk: int | None = None,
) -> Study:
    """The study that `sweep` would start with these arguments; nothing is written."""
    from stepwell.files import dumps

    given = aimed(what, given or {}, design)
    least = _CHUNKS_OF.get(what, _CHUNK)
    if given.get("engine") == WARP:
        # Robots screened together, each in all of its layouts.
        least = max(1, _WORLDS // max(given.get("layouts", 1), 1))
    size = chunk or max(least, -(-designs.count // _MOST_CHUNKS))
    study = Study(Path(folder), what, dumps(design), designs, size, given)
    study.columns  # noqa: B018  raises an error for an invalid study
    return study


def resumed(
    study: Study,
    workers: int | None = None,
    *,
    scheduler: str | None = None,
    progress: Progress = None,
    problems: Callable[[Sequence[str]], None] | None = None,
) -> Status:
    """Compute the missing chunks of a study; arguments and errors are those of `sweep`.

    `problems` is called after every chunk with the kinds of problems of its designs. After `cancel`
    a `CancelledError` is raised.
    """
    wanted = cores() if workers is None else workers
    if wanted < 0:
        raise InputError(f"workers = {workers}: must be 0 or more.")
    folder = study.folder.resolve()
    cancelled = study.folder / _CANCELLED
    cancelled.unlink(missing_ok=True)
    missing = study.missing()
    done = study.chunks - len(missing)
    tasks = ((str(folder), study.identity, number) for number in missing)
    if scheduler is None:
        ended = mapped(fill, tasks, min(wanted, max(len(missing), 1)))
    else:
        ended = mapped_on(scheduler, fill, tasks)
    failed: list[str] = []
    try:
        with closing(ended):
            for task, raised in ended:
                if raised is not None:
                    failed.append(f"chunk {task[-1]}: {raised}")
                    # The disk is full, or the version differs: all other chunks would fail too.
                    if isinstance(raised, OSError | StudyError):
                        break
                    continue
                done += 1
                if problems is not None:
                    problems(_problem_kinds(study.column(PROBLEM).get_block_selection(task[-1])))
                notify(progress, done, study.chunks)
                if cancelled.exists() and done < study.chunks:
                    raise CancelledError(_interruption_text(study, done, "It was cancelled."))
    except WorkerError as error:
        raise SweepError(_interruption_text(study, done, str(error))) from None
    if failed:
        more = f"; and {len(failed) - 1} more" if len(failed) > 1 else ""
        raise SweepError(_interruption_text(study, done, f"{failed[0]}{more}."))
    return status(study)


def _interruption_text(study: Study, done: int, why: str) -> str:
    return (
        f"{study.folder}: {done} of {study.chunks} chunks are finished. {why} To resume, run the "
        f"same command again."
    )


def cancel(study: Study) -> None:
    """Ask all workers of a study to stop after their current chunk."""
    (study.folder / _CANCELLED).touch()


def status(study: Study | str | os.PathLike[str]) -> Status:
    """Progress of a study, from its store; a folder without a study raises a `StudyError`."""
    study = study if isinstance(study, Study) else opened(study)
    missing = study.missing()
    done = sorted({*range(study.chunks)} - {*missing})
    problems = Counter(_problem_kinds(study.values(PROBLEM, done)))
    return Status(study, len(done), dict(problems.most_common()), tuple(study.gaps(missing)))


def _problem_kinds(problems: Iterable[object]) -> list[str]:
    """Kinds of the problems of failed designs."""
    return [str(one).partition(":")[0] for one in problems if one]
