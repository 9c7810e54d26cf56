#!/usr/bin/env python3
"""The code in docs/guide/python.md runs unchanged, from top to bottom."""
import contextlib
import io
import lzma
import os
import pathlib
import re
import tempfile
import unittest

from here import SOURCE

PAGE = SOURCE / "docs/guide/python.md"


class Page(unittest.TestCase):
    def test_code_of_the_page_runs(self):
        text = PAGE.read_text()
        blocks = list(re.finditer(r"^```python\n(.*?)^```$", text, re.M | re.S))
        self.assertGreater(len(blocks), 4)
        names = {}
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "flight.lcmlog").write_bytes(
                lzma.decompress((SOURCE / "logs/sample/lab_60s.lcmlog.xz").read_bytes()))
            os.chdir(folder)
            try:
                for block in blocks:
                    # Keeps the line numbers of the page, so that a traceback states the line of the page.
                    code = "\n" * text[:block.start(1)].count("\n") + block[1]
                    with contextlib.redirect_stdout(io.StringIO()) as printed:
                        exec(compile(code, PAGE, "exec"), names)
                    self.assertNotIn("nan", printed.getvalue())
            finally:
                os.chdir(here)


if __name__ == "__main__":
    unittest.main()
