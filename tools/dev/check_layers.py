#!/usr/bin/env python3
"""Checks the architecture. Fails if a folder includes a folder that MAY_INCLUDE does not permit, if
folders include each other in a cycle, or if test/FOLDER contains tests and FOLDER does not exist."""

import collections
import pathlib
import re
import sys

PURE = {"core", "models", "scenario"}
TRIAL = PURE | {"wire", "bus", "vantage_lcm", "planner", "estimator", "localizer", "sim", "drivers", "logs", "trial"}
MAY_INCLUDE = {
    "core": {"core"},
    "models": {"core", "models"},
    "wire": {"core", "models", "wire"},
    "scenario": PURE,
    "bus": PURE | {"bus", "vantage_lcm"},
    "planner": PURE | {"planner"},
    "estimator": PURE | {"estimator"},
    "localizer": PURE | {"localizer"},
    "sim": PURE | {"wire", "sim"},
    "drivers": PURE | {"wire", "drivers"},
    "logs": PURE | {"bus", "vantage_lcm", "logs"},
    "trial": TRIAL,
    "experiments": TRIAL | {"experiments"},
    "tools": TRIAL | {"experiments", "tools"},
    "python": TRIAL | {"experiments", "tools", "python"},
    "test": None,  # may include everything
}
# Folders `app` connect a process to the bus, so they may also include the bus.
APP_EXTRA = {"bus"}
# Folders of tests that do not test a folder of the same path: networks, benchmarks, complete programs, shared code.
TESTS_OF_NO_FOLDER = {"bench", "data", "docs", "examples", "fuzz", "guard", "integration", "mutation", "support", "view"}
INCLUDE = re.compile(r'^\s*#include "([^"]+)"')
LCM = re.compile(r'^\s*#include <lcm/')


def sources(root, folder):
    return (p for p in sorted((root / folder).rglob("*.[ch]pp")) if "node_modules" not in p.parts)


def violations(root):
    includes = collections.defaultdict(dict)  # folder -> included folder -> "file:line"
    for folder, allowed in MAY_INCLUDE.items():
        for path in sources(root, folder):
            rel = path.relative_to(root)
            may_see = None if allowed is None else allowed | (APP_EXTRA if "app" in rel.parts else set())
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if LCM.match(line) and folder not in ("bus", "logs", "test"):
                    yield f"{rel}:{number}: only bus/ and logs/ may include LCM"
                found = INCLUDE.match(line)
                if not found or may_see is None:
                    continue
                target = pathlib.PurePath(found.group(1))
                if target.parts[0] not in may_see:
                    yield f"{rel}:{number}: {folder}/ may not include {target.parts[0]}/"
                if str(target.parent) != str(rel.parent):
                    includes[str(rel.parent)].setdefault(str(target.parent), f"{rel}:{number}")
    yield from cycles(includes)
    yield from misplaced_tests(root)


def cycles(includes):
    """Yields one cycle for each group of folders that include each other, directly or indirectly."""
    done = set()

    def walk(folder, way):
        if folder in way:
            ring = way[way.index(folder):]
            yield "folders include each other: " + ", ".join(
                f"{a} sees {b} ({includes[a][b]})" for a, b in zip(ring, ring[1:] + ring[:1]))
            return
        if folder in done:
            return
        for target in sorted(includes.get(folder, ())):
            yield from walk(target, way + [folder])
        done.add(folder)

    for folder in sorted(includes):
        yield from walk(folder, [])


def misplaced_tests(root):
    for path in sorted((root / "test").rglob("*_test.cpp")):
        folder = path.relative_to(root / "test").parent
        if folder.parts[0] not in TESTS_OF_NO_FOLDER and not (root / folder).is_dir():
            yield f"{path.relative_to(root)}: tests of a folder {folder}/ that does not exist"


if __name__ == "__main__":
    bad = list(violations(pathlib.Path(sys.argv[1])))
    for line in bad:
        print(line)
    sys.exit(1 if bad else 0)
