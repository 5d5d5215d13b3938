"""`stepwell run`: what a design does, and how far it is from doing otherwise."""

from stepwell.cli.options import Design, Force, Json, Out


def run(design: Design, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """Say what a design does.

    Its sequence, its forces, every switch and snap, and how far it is from doing otherwise.
    With --out, the figures, the path as CSV, the result as JSON and a report in HTML are
    written into a folder, together with the design.
    """
    from stepwell import files, reports, results
    from stepwell.cli.options import free
    from stepwell.cli.screen import progress, show_result
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
            names = reports.write_run(
                cycle, limits, out, design=text, source=design, progress=tell, force=force
            )
    record = results.run_record(cycle, limits, design=text)
    show_result(record, _run_text.show, as_json, out, names)
