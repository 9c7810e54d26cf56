#!/usr/bin/env python3
"""The notebooks of examples/notebooks run from top to bottom, also in Jupyter's kernel if it is installed."""
import contextlib
import io
import json
import lzma
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from here import SOURCE

NOTEBOOKS = sorted((SOURCE / "examples/notebooks").glob("*.ipynb"))


class Notebooks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        pathlib.Path(cls.folder.name, "flight.lcmlog").write_bytes(
            lzma.decompress((SOURCE / "logs/sample/lab_60s.lcmlog.xz").read_bytes()))
        subprocess.run(["lcm-gen", "--python", "--ppath", cls.folder.name, *SOURCE.glob("lcmtypes/*.lcm")], check=True)
        sys.path.insert(0, cls.folder.name)
        cls.here = os.getcwd()
        os.chdir(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        os.chdir(cls.here)
        cls.folder.cleanup()

    def test_run_without_error(self):
        self.assertEqual(len(NOTEBOOKS), 4)
        for path in NOTEBOOKS:
            with self.subTest(path.name):
                names = {"__name__": "__main__"}
                with contextlib.redirect_stdout(io.StringIO()) as printed:
                    for cell in json.loads(path.read_text())["cells"]:
                        if cell["cell_type"] == "code":
                            exec(compile("".join(cell["source"]), path.name, "exec"), names)
                self.assertNotIn("nan", printed.getvalue())
                self.assertGreater(len(printed.getvalue().splitlines()), 0)

    def test_are_valid_and_contain_no_output(self):
        for path in NOTEBOOKS:
            notebook = json.loads(path.read_text())
            self.assertEqual((notebook["nbformat"], notebook["nbformat_minor"]), (4, 5))
            self.assertEqual(len({cell["id"] for cell in notebook["cells"]}), len(notebook["cells"]))
            self.assertFalse(any(cell.get("outputs") for cell in notebook["cells"]), path.name)

    def test_run_in_jupyter(self):
        try:
            import nbclient
            import nbformat
        except ImportError:
            self.skipTest("Jupyter is not installed (python3-nbclient, python3-ipykernel)")
        os.environ["PYTHONPATH"] = os.environ.get("PYTHONPATH", "") + os.pathsep + self.folder.name
        for path in NOTEBOOKS:
            nbclient.NotebookClient(nbformat.read(path, 4), timeout=120).execute()


if __name__ == "__main__":
    unittest.main()
