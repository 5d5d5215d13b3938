"""The JSON Schema of every record, generated from the schemas of its kind."""

from enum import Enum
from functools import reduce
from itertools import chain
from types import UnionType
from typing import Any

from stepwell.accounts.head import BARE, HEAD, shapes
from stepwell.accounts.kinds import KINDS, schema_at
from stepwell.base import InputError, Quantity, Schema, nearest_word

JsonSchema = dict[str, Any]

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_TYPES = {str: "string", bool: "boolean", int: "integer", dict: "object"}
# The first names of records without a computation; a folder has no packages of its own.
_FIRST = {"doctor": BARE, "presets": BARE}
_FIRST["folder"] = tuple(one for one in HEAD if one.name != "versions")


def schema_kinds() -> list[str]:
    """The kinds of records that have a schema, such as "run" or "lab.read"."""
    return [name.partition("/")[0] for name in sorted(KINDS)]


def schema_of(kind: str) -> JsonSchema:
    """The JSON Schema of a kind of record, over all shapes of chains.

    Raises:
        ValueError: there is no such kind; the text lists them all.
    """
    name = next((one for one in KINDS if one.partition("/")[0] == kind), None)
    if name is None:
        near = nearest_word(kind, schema_kinds())
        meant = f"Did you mean {near}?" if near else f"There are {', '.join(schema_kinds())}."
        raise InputError(f"{kind!r}: no result goes by this name. {meant}")
    schema, first = schema_at(name), _FIRST.get(kind, HEAD)
    schemas = [schema] if isinstance(schema, tuple) else map(schema, shapes())
    body = reduce(_merged, (_object((*first, *one)) for one in schemas))
    properties = {"schema": {"const": f"stepwell.{name}"}, **body["properties"]}
    properties.setdefault("files", {"type": "array", "items": {"type": "string"}})
    version = name.partition("/")[2]
    return {
        "$schema": _DIALECT,
        "$id": f"urn:stepwell:schema:{kind}:{version}",
        "title": f"stepwell.{name}",
        "description": f"Names and units: docs/commands/. A {kind} record of version {version} "
        "keeps these names; others may be added.",
        "type": "object",
        "properties": properties,
        "required": ["schema", *body["required"]],
    }


def _object(schema: Schema) -> JsonSchema:
    properties = {q.key: _property(q) for q in schema}
    return {"type": "object", "properties": properties, "required": list(properties)}


def _property(quantity: Quantity) -> JsonSchema:
    schema = _held(quantity.holds or (float if quantity.unit else str))
    if quantity.doc:
        schema["description"] = quantity.doc
    if quantity.missing:
        schema["type"] = _types(schema["type"], "null")
        if "enum" in schema:
            schema["enum"] = [*schema["enum"], None]
    return schema


def _held(holds: Any) -> JsonSchema:
    if isinstance(holds, tuple):
        return _object(holds)
    if isinstance(holds, list):
        return {"type": "array", "items": _held(holds[0])}
    if isinstance(holds, dict):
        return {"type": "object", "additionalProperties": _held(holds[str])}
    if holds is float:
        # A number that is not finite is null.
        return {"type": ["number", "null"]}
    if isinstance(holds, UnionType):
        return {"type": [_TYPES[one] for one in holds.__args__]}
    if isinstance(holds, type) and issubclass(holds, Enum):
        return {"type": "string", "enum": [one.name.lower() for one in holds]}
    return {"type": _TYPES[holds]}


def _merged(a: JsonSchema, b: JsonSchema) -> JsonSchema:
    """A schema that allows all that either of two schemas of the same quantity allows."""
    if a == b:
        return a
    schema = a | b | {"type": _types(a["type"], b["type"])}
    for part in {"items", "additionalProperties"} & a.keys() & b.keys():
        if isinstance(a[part], dict) and isinstance(b[part], dict):
            schema[part] = _merged(a[part], b[part])
    if "properties" in a and "properties" in b:
        both = a["properties"], b["properties"]
        schema["properties"] = {
            name: reduce(_merged, [one[name] for one in both if name in one])
            for name in both[0] | both[1]
        }
        schema["required"] = [one for one in a["required"] if one in b["required"]]
    return schema


def _types(*types: str | list[str]) -> str | list[str]:
    listed = [[one] if isinstance(one, str) else one for one in types]
    names = [*dict.fromkeys(chain.from_iterable(listed))]
    return names if names[1:] else names[0]
