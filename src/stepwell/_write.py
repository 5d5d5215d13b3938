"""Writing a file so that an interruption leaves the old one or the new one, never a half."""

import contextlib
import os
import tempfile
from pathlib import Path


def write_atomic(file: str | Path, data: str | bytes) -> None:
    """Write `data` under a temporary name in the same folder, sync it, and rename it.

    Args:
        file: where it shall stand.
        data: text (written as UTF-8) or bytes.

    Raises:
        OSError: the folder cannot be written; nothing is left behind.
    """
    target = Path(file)
    content = data.encode() if isinstance(data, str) else data
    handle, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        # mkstemp makes files private; a result is as readable as any other new file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
