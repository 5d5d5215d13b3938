"""`stepwell lab`: measured data in, calibrated bands and verdicts out."""

import typer

from stepwell.cli.lab import band, calibrate, compare, read
from stepwell.cli.screen import EXIT_CODES

app = typer.Typer(no_args_is_help=True, add_completion=False)
for command in (read.read, band.band, compare.compare, calibrate.calibrate):
    app.command(name=command.__name__, epilog=EXIT_CODES)(command)


@app.callback()
def lab() -> None:
    """Read recordings of a test machine, fit bands, and compare with the model."""
