#!/usr/bin/env python3
"""Fails if a folder includes a folder it may not see. The table is the architecture."""

import pathlib
import re
import sys

BASE = {"core", "models"}
MAY_INCLUDE = {
    "core": {"core"},
    "models": BASE,
    "bus": BASE | {"bus", "vantage_lcm"},
    "planner": BASE | {"planner"},
    "estimator": BASE | {"estimator"},
    "sim": BASE | {"sim"},
    "drivers": BASE | {"drivers"},
    "logs": BASE | {"bus", "vantage_lcm", "logs"},
    "tools": BASE | {"bus", "vantage_lcm", "planner", "estimator", "sim", "drivers", "logs", "tools"},
    "python": BASE | {"bus", "vantage_lcm", "planner", "estimator", "sim", "drivers", "logs", "tools", "python"},
    "test": None,  # may include everything
}
# The app room of a process is its border: it alone also sees the bus.
APP_EXTRA = {"bus"}
INCLUDE = re.compile(r'^\s*#include "([^"/]+)/')
LCM = re.compile(r'^\s*#include <lcm/')


def violations(root):
    for folder, allowed in MAY_INCLUDE.items():
        for path in sorted((root / folder).rglob("*.[ch]pp")):
            rel = path.relative_to(root)
            seen = None if allowed is None else allowed | (APP_EXTRA if "app" in rel.parts else set())
            for number, line in enumerate(path.read_text().splitlines(), 1):
                found = INCLUDE.match(line)
                if seen is not None and found and found.group(1) not in seen:
                    yield f"{rel}:{number}: {folder}/ may not include {found.group(1)}/"
                if LCM.match(line) and folder not in ("bus", "logs", "test"):
                    yield f"{rel}:{number}: only bus/ and logs/ may include LCM"


if __name__ == "__main__":
    bad = list(violations(pathlib.Path(sys.argv[1])))
    for line in bad:
        print(line)
    sys.exit(1 if bad else 0)
