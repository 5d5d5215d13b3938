"""Entry point of `stepwell` and `python -m stepwell`."""

import gc
import os
import signal
import sys

from stepwell.crash import leave, reported


def main() -> None:
    """Run the command line; until it is imported, Ctrl-C ends the program at once.

    An unexpected error of any package ends in one line and a report.
    """
    signal.signal(signal.SIGINT, leave)
    # Matrices are small here. Threads of the linear algebra would wait for each other: a fit takes
    # ten times as long on a busy machine. NumPy reads this as it is imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # A command keeps most objects that it makes: garbage collection took a tenth of its time.
    gc.set_threshold(10_000, 10, 10)
    try:
        from stepwell.cli import main

        main()
    except Exception as error:
        line = reported(error, sys.argv[1:])
        if sys.stderr is not None:
            print(line, file=sys.stderr)  # noqa: T201
        sys.exit(1)


if __name__ == "__main__":
    main()
