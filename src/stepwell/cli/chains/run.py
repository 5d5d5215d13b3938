"""`stepwell run`: what a design does, and how far it is from doing otherwise."""

from stepwell.cli.options.common import Design, Force, Json, Out


def run(design: Design, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """Say what a design does.

    Its sequence, its forces, every switch and snap, and how far it is from doing otherwise.
    With --out, the figures, the path as CSV, the result as JSON and a report in HTML are
    written into a folder, together with the design.
    """
    from stepwell import files
    from stepwell.cli.options.folders import free
    from stepwell.cli.screen.progress import progress
    from stepwell.cli.screen.show import show_json, show_written
    from stepwell.cli.text import run as _run_text
    from stepwell.design import margin

    text = files.read(design)
    chain = files.loads_chain(text, design)
    free(out, "run", force, design=text)
    with progress("following") as tell:
        cycle = chain.cycle(progress=tell)
    with progress("margin") as tell:
        limits = margin(cycle.chain, progress=tell)
    names = ()
    if out is not None:
        with progress("writing") as tell:
            names = files.write_run(
                cycle, limits, out, design=text, source=design, progress=tell, force=force
            )
    record = files.run_record(cycle, limits, design=text)
    if as_json:
        show_json(record, out, names)
    else:
        _run_text.show(record)
        show_written(out, names)
