"""Run a study: what is missing in its store, on all cores of this machine."""

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
from stepwell.studies.found import Extent, Frequency, Varied, extents, frequencies, varied
from stepwell.studies.influence import DecidingNumbers, decided
from stepwell.studies.mapper import WorkerError, mapped, mapped_on
from stepwell.studies.screen import Screened, aimed, screened
from stepwell.studies.store import PROBLEM, Gap, Study, StudyError, begun, opened
from stepwell.studies.work import WARP

# Of a chunk that nobody has given the size of: some seconds, and files that are not too many.
_CHUNK, _MOST_CHUNKS = 64, 10_000
_CHUNKS_OF = {"walk": 16, "maze": 1}
_WORLDS = 256
_CANCELLED = ".cancelled"


class SweepError(StepwellError, RuntimeError):
    """A study that could not be finished; what is done stays."""


class CancelledError(SweepError):
    """A study that somebody has cancelled; what is done stays."""


@dataclass(frozen=True, eq=False)
class Status(ByValue, Shown):
    """How far a study is, and what it has found so far.

    Attributes:
        study: which.
        done: chunks that are there and hold.
        gaps: designs that are missing.
        problems: how many designs could not be computed, by the kind of their problem.
    """

    study: Study
    done: int
    problems: dict[str, int]
    gaps: tuple[Gap, ...] = ()

    @property
    def finished(self) -> bool:
        """Whether nothing is missing."""
        return self.done == self.study.chunks

    @cached_property
    def varied(self) -> tuple[Varied, ...]:
        """What differs from design to design."""
        return varied(self.study)

    @cached_property
    def outcomes(self) -> tuple[Frequency, ...]:
        """How often each outcome occurs, of every column of words the most frequent first."""
        return frequencies(self.study)

    @cached_property
    def numbers(self) -> tuple[Extent, ...]:
        """The range of every number that was found."""
        return extents(self.study)

    @cached_property
    def decided(self) -> tuple[DecidingNumbers, ...]:
        """Which number decides what, see `studies.decided`."""
        return decided(self.study)

    @cached_property
    def screened(self) -> Screened | None:
        """How a screen and what was computed agree, see `studies.screened`."""
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
    """Compute something of many designs, into a store that loses nothing.

    A call with the same arguments goes on with what is missing; whatever was killed in between, the
    finished store has the same bytes.

    Args:
        design: the chain or robot that is varied.
        what: is computed: "cycle", "margin", "yield", "graph" or "program" of chains, "walk" or
            "maze" of robots, "call" of either.
        designs: a `Space` of its numbers, a `Workshop`, or a `ListedDesigns`.
        folder: of the store, which xarray opens as Zarr.
        given: what `what` takes besides the design, as `work_of` says.
        chunk: designs that are computed and written together; by default 64, or more where the
            study has more than 640,000; 16 of walks, 1 of mazes, 256 of what is screened.
        workers: processes at once; one for every core by default; 0 computes in this process, which
            needs no `if __name__ == "__main__":` in a script.
        scheduler: address of a running Dask scheduler, whose workers do it instead; they must see
            the folder under this name, and have this version of Stepwell.
        progress: called with (done, all) chunks.

    Raises:
        ValueError: a number that the design does not have, or nothing of that name to compute.
        StudyError: the folder holds another study, or one that another version has begun.
        SweepError: chunks could not be computed or written; the text says why.
        ExtraError: the extra studies, or for a scheduler the extra cluster, is not installed.
    """
    study = asked(design, what, designs, folder, given=given, chunk=chunk)
    return resumed(begun(study), workers, scheduler=scheduler, progress=progress)


def asked(
    design: Subject,
    what: str,
    designs: Designs,
    folder: str | os.PathLike[str],
    *,
    given: Mapping[str, Any] | None = None,
    chunk: int | None = None,
) -> Study:
    """The study that `sweep` begins with these arguments, which it explains; nothing is written."""
    from stepwell.files import dumps

    given = aimed(what, given or {}, design)
    least = _CHUNKS_OF.get(what, _CHUNK)
    if given.get("engine") == WARP:
        # Robots that are screened together, each in all of its layouts.
        least = max(1, _WORLDS // max(given.get("layouts", 1), 1))
    size = chunk or max(least, -(-designs.count // _MOST_CHUNKS))
    study = Study(Path(folder), what, dumps(design), designs, size, given)
    study.columns  # noqa: B018  refuses what cannot be computed
    return study


def resumed(
    study: Study,
    workers: int | None = None,
    *,
    scheduler: str | None = None,
    progress: Progress = None,
    problems: Callable[[Sequence[str]], None] | None = None,
) -> Status:
    """Compute what is missing of a study; arguments and errors as for `sweep`.

    `problems` is called after every chunk with the kinds of the problems of its designs; after
    `cancel` a `CancelledError` is raised.
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
                    # The disk is full, or this is another version: no other chunk can do better.
                    if isinstance(raised, OSError | StudyError):
                        break
                    continue
                done += 1
                if problems is not None:
                    problems(_kinds(study.column(PROBLEM).get_block_selection(task[-1])))
                notify(progress, done, study.chunks)
                if cancelled.exists() and done < study.chunks:
                    raise CancelledError(_left(study, done, "It was cancelled."))
    except WorkerError as error:
        raise SweepError(_left(study, done, str(error))) from None
    if failed:
        more = f"; and {len(failed) - 1} more" if len(failed) > 1 else ""
        raise SweepError(_left(study, done, f"{failed[0]}{more}."))
    return status(study)


def _left(study: Study, done: int, why: str) -> str:
    return (
        f"{study.folder}: {done} of {study.chunks} chunks are done. {why} The same command goes on "
        f"with the others."
    )


def cancel(study: Study) -> None:
    """Have whoever works on a study stop after the chunks that are being computed."""
    (study.folder / _CANCELLED).touch()


def status(study: Study | str | os.PathLike[str]) -> Status:
    """How far a study is, by what its store holds; a `StudyError` for a folder without one."""
    study = study if isinstance(study, Study) else opened(study)
    missing = study.missing()
    done = sorted({*range(study.chunks)} - {*missing})
    problems = Counter(_kinds(study.values(PROBLEM, done)))
    return Status(study, len(done), dict(problems.most_common()), tuple(study.gaps(missing)))


def _kinds(problems: Iterable[object]) -> list[str]:
    """Of designs that could not be computed the kinds of their problems."""
    return [str(one).partition(":")[0] for one in problems if one]
