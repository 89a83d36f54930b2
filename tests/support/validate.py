"""Validates the files of each format against its schema, and checks that changed files are invalid: one change of each kind at each
field, wherever its lists have it first.

Usage: validate.py FOLDER, where FOLDER/FORMAT has a `schema` and files `*.json`.
"""

import copy
import json
import pathlib
import sys

from jsonschema import Draft202012Validator


def places(value, path=()):
    """Yields the path of each value."""
    yield path
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in entries:
        yield from places(child, path + (key,))


def changed(document, path):
    """Yields invalid copies of a document, each with a change at a path."""
    def copied():
        whole = copy.deepcopy(document)
        if not path:
            return whole, None, None
        parent = whole
        for key in path[:-1]:
            parent = parent[key]
        return whole, parent, path[-1]

    value = document
    for key in path:
        value = value[key]
    if isinstance(value, dict):
        whole, parent, key = copied()
        target = whole if parent is None else parent[key]
        target["no_such_field"] = [[[]]]
        yield "an unknown field", whole
    if path:
        whole, parent, key = copied()
        parent[key] = {"no": {"such": {"value": True}}}
        yield "another type", whole
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            whole, parent, key = copied()
            parent[key] = "1"
            yield "a text for a number", whole


def main():
    for folder in sorted(pathlib.Path(sys.argv[1]).iterdir()):
        schema = json.loads((folder / "schema").read_text("utf-8"))
        Draft202012Validator.check_schema(schema)
        validator = Draft202012Validator(schema)
        valid, seen = 0, set()
        for file in sorted(folder.glob("*.json")):
            document = json.loads(file.read_text("utf-8"))
            for error in validator.iter_errors(document):
                sys.exit(f"{folder.name}/{file.name}: {error.json_path}: {error.message}")
            valid += 1
            for path in places(document):
                field = tuple("*" if isinstance(key, int) else key for key in path)
                for what, mutant in changed(document, path):
                    if (field, what) in seen:
                        continue
                    seen.add((field, what))
                    if validator.is_valid(mutant):
                        sys.exit(f"{folder.name}/{file.name}: {what} at {path} is accepted")
        print(f"{folder.name}: {valid} valid, {len(seen)} changes found")


main()
