"""The JSON Schema of every record: what is published, and whether a record keeps to it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files
from typing import Any

from stepwell import accounts
from stepwell.base import InputError, nearest_word

JsonSchema = dict[str, Any]

_PUBLISHED = files("stepwell.results").joinpath("schemas")
_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NAME = re.compile(r"stepwell\.([a-z_.]+)/(\d+)")
# What these hold goes by the names of a design, a sample or a package.
_BY_NAME = {
    "correlations", "data_sha256", "designs_sha256", "each", "pathway_shares", "shares", "values",
    "versions",
}  # fmt: skip
# What these are where a result is made in Python, too.
_NULLABLE = {"design_sha256": ["string", "null"], "seed": ["integer", "null"]}
_ORDER = "object", "array", "string", "boolean", "integer", "number", "null"
_PYTHON = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "integer": int,
    "number": (int, float),
    "null": type(None),
}


def schema_kinds() -> list[str]:
    """The kinds of records that have a schema, such as "run" or "lab.read"."""
    files = (file.name[:-5] for file in _PUBLISHED.iterdir() if file.name.endswith(".json"))
    return sorted({*files, *accounts.schema_kinds()})


def schema_of(kind: str) -> JsonSchema:
    """The JSON Schema of a kind of record.

    Raises:
        ValueError: there is no such kind; the text lists them all.
    """
    if kind in accounts.schema_kinds():
        return accounts.schema_of(kind)
    known = schema_kinds()
    if kind not in known:
        near = nearest_word(kind, known)
        meant = f"Did you mean {near}?" if near else f"There are {', '.join(known)}."
        raise InputError(f"{kind!r}: no result goes by this name. {meant}")
    return json.loads(_PUBLISHED.joinpath(f"{kind}.json").read_text("utf-8"))


def kind_of(record: Mapping[str, Any]) -> str:
    """The kind of a record, as its `schema` says."""
    found = _NAME.fullmatch(str(record.get("schema")))
    if found is None:
        raise InputError(f"schema = {record.get('schema')!r}: must be as in stepwell.run/1.")
    return found[1]


def widened(schema: JsonSchema | None, record: Mapping[str, Any]) -> JsonSchema:
    """A schema that a record keeps to as well; of a new version, that of the record alone."""
    name = record["schema"]
    kind, version = kind_of(record), name.rpartition("/")[2]
    body = _shape(record)
    body["properties"]["schema"] = {"const": name}
    if schema is not None and schema["properties"]["schema"] == {"const": name}:
        body = _merged(schema, body)
    told = {
        "title": name,
        "description": f"Names and units: docs/commands.md. A {kind} record of version {version} "
        "keeps these names; others may be added.",
    }
    return {"$schema": _DIALECT, "$id": f"urn:stepwell:schema:{kind}:{version}", **told} | {
        key: part for key, part in body.items() if key not in told
    }


def violations(record: Mapping[str, Any]) -> list[str]:
    """Where a record does not keep to its published schema: place, what came, what is allowed."""
    return list(_problems(schema_of(kind_of(record)), record, "record"))


def _shape(value: Any, name: str = "") -> JsonSchema:
    if isinstance(value, Mapping):
        if name in _BY_NAME:
            return {"type": "object", "additionalProperties": _all(value.values())}
        properties = {key: _shape(part, key) for key, part in value.items()}
        return {"type": "object", "properties": properties, "required": sorted(properties)}
    if isinstance(value, list):
        return {"type": "array", "items": _all(value)}
    if isinstance(value, float):
        # Not finite is null, whatever the quantity.
        return {"type": ["number", "null"]}
    kind = next(kind for kind, of in _PYTHON.items() if type(value) is of)
    return {"type": _NULLABLE.get(name, kind)}


def _all(values: Iterable[Any]) -> JsonSchema:
    found: JsonSchema = {}
    for value in values:
        found = _merged(found, _shape(value))
    return found


def _merged(a: JsonSchema, b: JsonSchema) -> JsonSchema:
    """What allows all that either allows; `{}`, of which nothing was seen, adds nothing."""
    if not a or not b or "const" in a:
        return a or b
    types = {*_types(a), *_types(b)}
    if "number" in types:
        types.discard("integer")
    rest = [kind for kind in _ORDER if kind in types]
    found: JsonSchema = {"type": rest if rest[1:] else rest[0]}
    for part in ("items", "additionalProperties"):
        if part in a or part in b:
            found[part] = _merged(a.get(part, {}), b.get(part, {}))
    if "properties" in a and "properties" in b:
        names = dict.fromkeys([*a["properties"], *b["properties"]])
        found["properties"] = {
            name: _merged(a["properties"].get(name, {}), b["properties"].get(name, {}))
            for name in names
        }
        found["required"] = sorted({*a["required"]} & {*b["required"]})
    else:
        one = a if "properties" in a else b
        found |= {key: one[key] for key in ("properties", "required") if key in one}
    return found


def _problems(schema: JsonSchema, value: Any, place: str) -> Iterator[str]:
    """The part of JSON Schema that the published ones use."""
    if "const" in schema:
        if value != schema["const"]:
            yield f"{place} = {value!r}: must be {schema['const']!r}."
        return
    allowed = _types(schema)
    if allowed and not any(_is(value, kind) for kind in allowed):
        yield f"{place} = {str(value)[:60]}: must be {' or '.join(allowed)}."
        return
    if isinstance(value, list):
        for k, part in enumerate(value):
            yield from _problems(schema.get("items", {}), part, f"{place}[{k}]")
    elif isinstance(value, Mapping):
        yield from (
            f"{place} lacks {one}." for one in schema.get("required", ()) if one not in value
        )
        known = schema.get("properties")
        for name, part in value.items():
            # Names may be added, but not unsaid.
            if known is not None and name not in known:
                yield f"{place}.{name}: is not in the published schema."
            inner = (known or {}).get(name) or schema.get("additionalProperties", {})
            yield from _problems(inner, part, f"{place}.{name}")


def _types(schema: JsonSchema) -> list[str]:
    found = schema.get("type", [])
    return [found] if isinstance(found, str) else found


def _is(value: Any, kind: str) -> bool:
    return isinstance(value, _PYTHON[kind]) and (kind == "boolean" or not isinstance(value, bool))
