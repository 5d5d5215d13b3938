"""What a command has written into a folder, once the folder is known to be whole."""

import json
from pathlib import Path

from stepwell.files import manifest


def written(folder: Path) -> set[str]:
    """The names of the results in a folder that holds nothing else and says so."""
    content = manifest(folder)
    assert {file.name for file in folder.iterdir()} == {*content["files"], "stepwell.json"}
    for name in content["files"]:
        if name.endswith(".json"):
            record = json.loads((folder / name).read_text("utf-8"))
            assert record.get("design_sha256") == content["design_sha256"]
            assert record.get("seed") == content["seed"]
            assert record["versions"]["numpy"]
            assert record["stepwell"] == content["stepwell"]
    return set(content["files"])
