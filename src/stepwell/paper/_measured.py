"""Claims that recordings decide; the recordings are not part of Stepwell."""

from functools import partial

from stepwell.paper.claim import Claim, Finding, Judgement


def _missing(reading: str) -> Finding:
    return Finding("", Judgement.NEEDS_DATA, reading)


CLAIMS = (
    Claim(
        "measured-stiffness",
        "The rubber bands of the unit cells have k = 28.5 N/m.",
        "band tests published with the paper",
        "28.5 N/m",
        "to be set with the data",
        partial(
            _missing, "Has to be fitted to the recorded tension tests, which are not read yet."
        ),
    ),
    Claim(
        "measured-unit-cell",
        "Measured forces of the unit cells follow the model.",
        "unit-cell tests published with the paper",
        "they agree",
        "to be set with the data",
        partial(_missing, "Has to be compared with the recorded forces, which are not read yet."),
    ),
    Claim(
        "measured-order",
        "Two cells on the test machine move in the predicted order.",
        "two-cell tests published with the paper",
        "they do",
        "to be set with the data",
        partial(_missing, "Has to be compared with the recorded forces, which are not read yet."),
    ),
)
