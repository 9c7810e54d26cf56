"""What Python values become before the library reads them."""
import json
import os


def _plain(value):
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"neither a number, text, list nor dict: {value!r}")


def to_json(value):
    """`value` as JSON text, a key a line, so that a message's line can be found in it."""
    return json.dumps(value, default=_plain, ensure_ascii=False, indent=1)
