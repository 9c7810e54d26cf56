#!/usr/bin/env python3
"""coverage_test.py SOURCE_DIR: tools/dev/coverage adds up gcovr's numbers for files by folder."""

import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
SOURCE = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else ".").resolve()
LOADER = importlib.machinery.SourceFileLoader("coverage_tool", str(SOURCE / "tools" / "dev" / "coverage"))
coverage = importlib.util.module_from_spec(importlib.util.spec_from_loader("coverage_tool", LOADER))
LOADER.exec_module(coverage)


def counts(name, lines, run, branches, taken):
    return {"filename": name, "line_total": lines, "line_covered": run, "branch_total": branches,
            "branch_covered": taken}


class Table(unittest.TestCase):
    def test_sums_by_folder_and_for_flight_safety(self):
        sums = coverage.by_folder([counts("core/a.cpp", 10, 9, 4, 1), counts("core/b/c.hpp", 30, 11, 0, 0),
                                   counts("drivers/x.cpp", 5, 5, 2, 2), counts("drivers/safety/y.cpp", 7, 0, 3, 0),
                                   counts("drivers/safety_belt.cpp", 1, 1, 0, 0)])
        self.assertEqual(sums, {"core": [40, 20, 4, 1], "drivers": [6, 6, 2, 2], "drivers/safety": [7, 0, 3, 0]})
        self.assertEqual(coverage.table(sums)[2:], [
            "| core | 40 | 50.0 % | 4 | 25.0 % |",
            "| drivers | 6 | 100.0 % | 2 | 100.0 % |",
            "| drivers/safety | 7 | 0.0 % | 3 | 0.0 % |",
            "| **all** | 53 | 49.1 % | 9 | 33.3 % |"])

    def test_without_lines_has_no_share(self):
        self.assertEqual(coverage.table({"core": [0, 0, 0, 0]})[2], "| core | 0 | — | 0 | — |")
        self.assertEqual(coverage.table({})[2:], ["| **all** | 0 | — | 0 | — |"])

    def test_counts_every_folder_with_sources(self):
        rooms = {path.relative_to(SOURCE).parts[0] for path in SOURCE.glob("*/CMakeLists.txt")
                 if any(path.parent.rglob("*.cpp"))}
        self.assertEqual(rooms - {"test", "examples", "build"}, set(coverage.ROOMS))


if __name__ == "__main__":
    unittest.main()
