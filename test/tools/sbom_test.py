#!/usr/bin/env python3
"""sbom_test.py SOURCE_DIR PROGRAM: checks that tools/dev/sbom lists the components of a program as the
package manager knows them, with the same bytes each time.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

source, program = pathlib.Path(sys.argv[1]), sys.argv[2]
if subprocess.run(["sh", "-c", "command -v dpkg-query"], stdout=subprocess.DEVNULL, check=False).returncode:
    print("skipped: no dpkg here")
    sys.exit(77)


def made(**environment):
    return subprocess.run(
        [source / "tools/dev/sbom", "--version", "1.2.3", "--sources", "libeigen3-dev", "--npm",
         source / "tools/view/page/package.json", "--programs", program],
        capture_output=True, text=True, check=True, env={**os.environ, **environment}).stdout


text = made(SOURCE_DATE_EPOCH="1700000000")
assert text == made(SOURCE_DATE_EPOCH="1700000000"), "two runs with the same input differ"
bill = json.loads(text)
assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.5")
assert bill["metadata"]["timestamp"] == "2023-11-14T22:13:20Z"
assert re.fullmatch(r"urn:uuid:[0-9a-f-]{36}", bill["serialNumber"])
parts = {part["name"]: part for part in bill["components"]}
for name in "liblcm1", "libsodium23", "libc6", "libeigen3-dev":
    version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}\n", name], capture_output=True, text=True, check=True)
    assert parts[name]["version"] == version.stdout.split()[0], name
assert parts["three"]["purl"].startswith("pkg:npm/three@")
references = [part["bom-ref"] for part in bill["components"]]
assert len(set(references)) == len(references) and bill["dependencies"][0]["dependsOn"] == references
assert str(source) not in text, "contains a path of this machine"
# Without SOURCE_DATE_EPOCH the file has no time stamp.
without = {key: value for key, value in os.environ.items() if key != "SOURCE_DATE_EPOCH"}
os.environ.clear()
os.environ.update(without)
assert "timestamp" not in json.loads(made())["metadata"]
