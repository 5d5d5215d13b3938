"""`stepwell program`: what the actuator has to do to bring a chain to a state."""

from stepwell.cli.options import Design, Force, From, Json, Out, To


def program(
    design: Design,
    start: From = None,
    to: To = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find the fewest turning points of the actuator from one state to another.

    Each comes with the window in which turning does the same; or you get the proof that no
    program does it. Without --to, the program in the design file is played, and you are told
    whether it ends as it should. With --out, a figure, the turning points as CSV, the result
    as JSON and the design with the program in it are written into a folder.
    """
    from stepwell import files, reports, results
    from stepwell.cli.options import free, own, planned
    from stepwell.cli.screen import answered, progress, show_result
    from stepwell.cli.text import program as _program_text
    from stepwell.sequences import Unreachable

    text = files.read(design)
    chain = files.loads_chain(text, design)
    free(out, "program", force)
    names: tuple[str, ...] = ()
    try:
        found = planned(chain, start, to) if start or to else own(text, design)
    except Unreachable as why:
        record, out = results.unreachable_record(chain, start, to, why, design=text), None
    else:
        record = results.program_record(found, design=text)
        if out is not None:
            with progress("writing") as tell:
                names = reports.write_program(found, out, design=text, progress=tell, force=force)
    show_result(record, _program_text.show, as_json, out, names)
    answered(record["does_it"])
