"""Paths and the command that the tests share."""
import json
import os
import pathlib
import subprocess

SOURCE = pathlib.Path(os.environ["VANTAGE_SOURCE"])
BINARY = os.environ["VANTAGE_BINARY"]
PROBLEMS = SOURCE / "test/tools/problems"


def command(*arguments, code=0):
    """Returns the standard output and standard error of `vantage ARGUMENTS`."""
    done = subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == code, f"exit code {done.returncode}: {done.stderr}"
    return done.stdout, done.stderr


def command_json(*arguments, code=0):
    return json.loads(command(*arguments, "--json", code=code)[0])
