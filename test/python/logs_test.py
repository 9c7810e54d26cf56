#!/usr/bin/env python3
"""A log's columns equal the output of `vantage log export`."""
import csv
import lzma
import os
import pathlib
import tempfile
import unittest

import numpy
import vantage
from here import SOURCE, command


class Log(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "flight.lcmlog")
        pathlib.Path(cls.path).write_bytes(lzma.decompress((SOURCE / "logs/sample/lab_60s.lcmlog.xz").read_bytes()))
        cls.log = vantage.Log(cls.path)
        cls.tables = os.path.join(cls.folder.name, "csv")
        command("log", "export", cls.path, "--to", "csv", "--raw", "--out", cls.tables)

    @classmethod
    def tearDownClass(cls):
        del cls.log
        cls.folder.cleanup()

    def test_channels_equal_those_of_the_command(self):
        printed, _ = command("log", "info", self.path)
        self.assertIn("PLAN_Q1", self.log)
        for name, channel in self.log.channels.items():
            self.assertIn(name, printed)
            self.assertEqual(len(self.log[name].log_utime), channel.messages)
            self.assertEqual(self.log[name].refused, 0)

    def test_values_equal_those_of_the_tables(self):
        compared = 0
        for name in self.log:
            with open(os.path.join(self.tables, f"{name}.csv"), newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            columns = self.log[name]
            for field in columns:
                values, of_list = columns[field], columns._lists[field]
                names = [field] if values.ndim == 1 else [f"{field}_{i}" for i in range(values.shape[1])]
                # Skips lists that are written into one cell, lists within lists, matrices, and fields that
                # the table lacks.
                if of_list == field or (of_list or "").count(".") or names[0] not in rows[0] or values.ndim > 2:
                    continue
                for i, column in enumerate(names):
                    self.check(of_list, values if values.ndim == 1 else values[:, i], rows, column)
                    compared += 1
        self.assertGreater(compared, 150)

    def check(self, of_list, values, rows, column):
        if of_list is None:  # repeated for each element of the list; the first is enough
            keys = [(row["log_utime"], row["run_id"], row["sequence"]) for row in rows]
            rows = [row for i, row in enumerate(rows) if i == 0 or keys[i] != keys[i - 1]]
        else:  # a message without elements is a line with empty cells
            rows = [row for row in rows if any(cell for name, cell in row.items() if name.startswith(of_list + "."))]
        self.assertEqual(len(rows), len(values), column)
        for row, value in zip(rows, values):
            text = row[column]
            if isinstance(value, numpy.bool_):
                self.assertEqual(text, "true" if value else "false", column)
            elif isinstance(value, str):
                self.assertEqual(text, value, column)
            elif text == "":
                self.assertFalse(numpy.isfinite(value), column)
            else:
                self.assertEqual(float(text), float(value), column)

    def test_lists_are_concatenated(self):
        plans = self.log["PLAN_Q1"]
        counts = numpy.diff(plans.offsets["segments"])
        self.assertEqual(len(counts), len(plans.log_utime))
        self.assertEqual(counts.sum(), len(plans["segments.duration_s"]))
        self.assertEqual(len(plans.split("segments.duration_s")), len(plans.log_utime))
        self.assertEqual(plans.row("segments.duration_s").tolist(), numpy.repeat(range(len(counts)), counts).tolist())
        self.assertEqual(plans["cost_nat"].dtype, float)
        with self.assertRaisesRegex(KeyError, "no field cost; the fields are .*cost_nat"):
            plans["cost"]

    def test_reads_a_time_interval(self):
        whole, part = self.log["TRUTH"], self.log.read("TRUTH", from_s=20, to_s=30)
        since_s = 1e-6 * (whole.log_utime - self.log.start_utime)
        inside = (since_s >= 20) & (since_s < 30)
        self.assertEqual(part.log_utime.tolist(), whole.log_utime[inside].tolist())
        self.assertGreater(len(part.log_utime), 100)

    def test_truncated_file_gives_its_intact_events(self):
        torn = os.path.join(self.folder.name, "torn.lcmlog")
        data = pathlib.Path(self.path).read_bytes()
        pathlib.Path(torn).write_bytes(data[:len(data) // 3] + b"junk" * 50 + data[len(data) // 3:-7])
        log = vantage.Log(torn)
        self.assertGreater(log.damaged_bytes, 0)
        self.assertEqual(self.log.damaged_bytes, 0)
        lost = sum(each.messages for each in self.log.channels.values()) - sum(
            each.messages for each in log.channels.values())
        self.assertIn(lost, (1, 2))

    def test_refuses_other_files(self):
        with self.assertRaisesRegex(vantage.StartupError, "nowhere.lcmlog"):
            vantage.Log("nowhere.lcmlog")
        with self.assertRaisesRegex(KeyError, "no channel NOPE"):
            self.log["NOPE"]


if __name__ == "__main__":
    unittest.main()
