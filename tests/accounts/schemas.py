"""Whether a record has exactly the names and types that its published JSON Schema gives."""

import json
import re
from copy import deepcopy
from functools import cache
from typing import Any

import jsonschema

from stepwell.accounts import schema_of

_NAME = re.compile(r"stepwell\.([a-z_.]+)/(\d+)")


def violations(record: dict[str, Any]) -> list[str]:
    """The places where a record differs from its schema: also names that the schema lacks.

    Args:
        record: as a command prints it, or as `Account.record` has it.
    """
    # As a program reads it.
    read = json.loads(json.dumps(record, allow_nan=False))
    kind = _NAME.fullmatch(read["schema"])
    assert kind is not None, read["schema"]
    return [
        f"{one.json_path}: {one.message[:200]}" for one in _validator(kind[1]).iter_errors(read)
    ]


@cache
def _validator(kind: str) -> jsonschema.Draft202012Validator:
    schema = schema_of(kind)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(_closed(deepcopy(schema)))


def _closed(schema: Any) -> Any:
    """The same schema with no name allowed that it does not list."""
    if isinstance(schema, dict):
        for part in schema.values():
            _closed(part)
        if "properties" in schema and "additionalProperties" not in schema:
            schema["additionalProperties"] = False
    return schema
