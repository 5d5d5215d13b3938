"""One of every result of recordings, small, by the name of its class."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import stepwell as sw
from golden.recordings import bands, cells, clip, rubber
from lab.test_copy import recorded
from stepwell import lab


@cache
def calibration() -> lab.Calibration:
    """Bands whose law is a line."""
    with TemporaryDirectory() as folder:
        rubber(Path(folder))
        rubbers = lab.read_all([Path(folder) / "rubber"]).recordings
    sorted_ = lab.sort_series(rubbers)
    return lab.calibrate(lab.prepare(sorted_.series, notes=sorted_.notes), "linear")


@cache
def of_recordings() -> dict[str, Any]:
    """Of recordings and what they show."""
    with TemporaryDirectory() as folder:
        for prepare in (bands, cells, clip):
            prepare(Path(folder))
        batch = lab.read_all([Path(folder) / "data"])
        pulled = lab.read_all([Path(folder) / "bands"]).recordings
        clipped = lab.read(Path(folder) / "clip.csv")
    element = lab.measure_element(clipped)
    compared = lab.compare(batch.recordings)
    built = sw.preset("paper-forward")
    test = lab.band_test(pulled)
    values = (
        lab.copy_test(built, recorded(built)),
        lab.as_built(built, lab.Observed("00>10>11>01>00"), samples=100),
        batch,
        batch.recordings[0],
        test,
        lab.fit_bands(test, lab.choose_law(test)),
        compared,
        compared.cells[0],
        compared.pairs[0],
        lab.compare([clipped], [element.chain]).chains[0],
        element,
        calibration(),
    )
    return {type(value).__name__: value for value in values}
