"""`stepwell run`: what a design does, and how far it is from doing otherwise."""

from functools import partial

from stepwell.cli.options import Design, Force, Json, Out, free, read_chain
from stepwell.cli.screen import finish, progress


def run(design: Design, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """Say what a design does.

    Its sequence, its forces, every switch and snap, and how far it is from doing otherwise.
    With --out, the figures, the path as CSV, the result as JSON and a report in HTML are
    written into a folder, together with the design.
    """
    from stepwell import reports, results
    from stepwell.cli.text import chains as texts
    from stepwell.design import margin

    text, chain = read_chain(design)
    free(out, "run", force, design=text)
    with progress("following") as tell:
        cycle = chain.cycle(progress=tell)
    with progress("margin") as tell:
        limits = margin(cycle.chain, progress=tell)
    record = results.run_record(cycle, limits, design=text)
    write = partial(reports.write_run, cycle, limits, design=text, source=design)
    finish(record, texts.run, as_json, out, force, write)
