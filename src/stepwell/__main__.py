"""What `stepwell` and `python -m stepwell` start."""

import os
import signal


def _leave(*_: object) -> None:
    os.write(2, b"Interrupted before anything was done.\n")
    os._exit(130)


def main() -> None:
    """Open the command line; until it is open, Ctrl-C ends the program at once."""
    signal.signal(signal.SIGINT, _leave)
    # Matrices are small here. Threads of the linear algebra would wait for each other: a fit takes
    # ten times as long on a busy machine. NumPy reads this as it is imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from stepwell.cli import main

    main()


if __name__ == "__main__":
    main()
