"""Conversion of Python values to the library's input."""
import json
import os


def _plain(value):
    if hasattr(value, "tolist"):  # numpy arrays and numbers
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"must be a number, text, list or dict, got {value!r}")


def to_json(value):
    """Returns `value` as JSON text with one key per line, so that an error's line number can be found in it."""
    return json.dumps(value, default=_plain, ensure_ascii=False, indent=1)
