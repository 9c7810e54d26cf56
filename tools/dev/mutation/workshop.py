"""Where mutations are built and tried: a copy of the tree in build/mutate/tree, built in
build/mutate/build. The checkout itself is only read, so nothing that ends this process can leave a
mutation in it; what is left in the copy is put right when the next session begins."""

import fcntl
import hashlib
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import subprocess
import time

from . import ledger, sites

INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.M)
GENERATED = "vantage_lcm_gen"  # headers that must be there before a file can be parsed
BUILD_LIMIT_S = 1800.0
QUICK_S = 0.5  # tests that take less are asked before those that take longer
WALL_LIMIT_S = 300  # of a test that waits instead, and has no limit of its own
# Optimised a little, with assertions, without what only a debugger reads: the quickest to build and run.
CONFIGURATION = ("-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O1",
                 "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DVANTAGE_BUILD_TESTS=ON")


class Trouble(Exception):
    """Something a person must put right first."""


def git(root, *words):
    return subprocess.run(["git", "-C", str(root), *words], check=True, capture_output=True,
                          text=True).stdout


def changed_files(root, but):
    """What git calls changed or unknown, except the files in `but`."""
    out = []
    for entry in git(root, "status", "--porcelain", "-z", "--no-renames",
                     "--untracked-files=all").split("\0"):
        name = entry[3:]
        if name and (root / name).resolve() not in but:
            out.append(name)
    return out


def changed_lines(root, revision):
    """By file, the lines that differ from a revision, as they are numbered now."""
    lines = {}
    name = None
    for line in git(root, "diff", "-U0", "--no-ext-diff", revision, "--", "*.cpp", "*.hpp").splitlines():
        if line.startswith("+++ "):
            name = line[6:] if line.startswith("+++ b/") else None
        match = re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line)
        if match and name:
            first, count = int(match.group(1)), int(match.group(2) or 1)
            lines.setdefault(name, set()).update(range(first, first + count))
    return lines


def source_files(root, path):
    """The C++ files at or below a path."""
    names = [name for name in git(root, "ls-files", "-z", "--", path).split("\0")
             if name.endswith((".cpp", ".hpp"))]
    if not path.startswith("test"):
        names = [name for name in names if not name.startswith("test/")]
    return sorted(names)


def hash_of(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class Workshop:
    def __init__(self, root, exclude_labels="", exclude_tests="", only="", is_quick=False, jobs=1,
                 limit_factor=5.0, limit_slack_s=5.0, say=print):
        self.root = pathlib.Path(root)
        self.place = self.root / "build" / "mutate"
        self.tree = self.place / "tree"
        self.build = self.place / "build"
        self.exclude_labels = exclude_labels
        self.exclude_tests = exclude_tests
        self.only = only
        self.is_quick = is_quick
        self.jobs = jobs
        self.limit_factor = limit_factor
        self.limit_slack_s = limit_slack_s
        self.say = say
        self.programs = None
        self.sites = {}
        self.object_hashes = {}
        self.baselines = {}
        self.numbers = None

    # --- the copy ---

    def open(self, is_for_tests):
        """One session at a time; the copy is as the checkout."""
        self.place.mkdir(parents=True, exist_ok=True)
        self.lock = open(self.place / "lock", "w")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Trouble("another session is at work in build/mutate") from None
        self.sync()
        if not (self.build / "build.ninja").exists():
            self.say("configuring build/mutate/build")
            self.command(["cmake", "-S", self.tree, "-B", self.build, *CONFIGURATION])
        if is_for_tests:
            self.read_graph()
        elif self.targets().get(GENERATED):
            self.command(["ninja", "-C", self.build, GENERATED])

    def sync(self):
        names = [n for n in git(self.root, "ls-files", "-z").split("\0") if n]
        wanted = {self.tree / name for name in names}
        for folder, _, files in os.walk(self.tree):
            for file in files:
                path = pathlib.Path(folder) / file
                if path not in wanted:
                    path.unlink()
        for name in names:
            source, copy = self.root / name, self.tree / name
            if not source.exists():
                continue
            if not copy.exists() or copy.read_bytes() != source.read_bytes():
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, copy)
            shutil.copymode(source, copy)
        # What stands beside the sources without being of them: fetched by npm, measured in a room.
        links = {self.tree.parent / "shared": self.root.parent / "shared"}
        for name in names:
            if name.endswith("package-lock.json"):
                modules = pathlib.Path(name).parent / "node_modules"
                links[self.tree / modules] = self.root / modules
        for link, target in links.items():
            if target.is_dir() and not link.is_symlink():
                link.symlink_to(target)

    # --- commands, none of which outlives us ---

    def command(self, words, limit_s=BUILD_LIMIT_S, is_checked=True, cpu_limit_s=None):
        """Output and exit code; None for the code when it had to be stopped. The CPU time is that of
        each process: seconds of a clock say nothing on a busy machine."""
        def limit():
            if cpu_limit_s is not None:
                resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(cpu_limit_s),) * 2)

        process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace",
                                   start_new_session=True, preexec_fn=limit)
        code = None
        try:
            output, _ = process.communicate(timeout=limit_s)
            code = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        if is_checked and code != 0:
            raise Trouble(f"{' '.join(map(str, words))}\n{output[-3000:]}")
        return output, code

    def ninja(self, targets, limit_s=BUILD_LIMIT_S, is_checked=True):
        return self.command(["ninja", "-j", self.jobs, "-C", self.build, *targets], limit_s, is_checked)

    # --- who sees what ---

    def targets(self):
        """Rule by target."""
        out = {}
        for line in self.command(["ninja", "-C", self.build, "-t", "targets", "all"])[0].splitlines():
            name, _, rule = line.partition(": ")
            out[name] = rule
        return out

    def read_graph(self):
        """Of each test program, the objects that it is linked from; of each object, its source."""
        self.command(["ninja", "-C", self.build, "build.ninja"])
        self.programs = {}
        for name, rule in self.targets().items():
            if rule.startswith("CXX_EXECUTABLE_LINKER") and name.endswith("_test") and \
                    re.search(self.only, name):
                inputs = self.command(["ninja", "-C", self.build, "-t", "inputs", name])[0].splitlines()
                self.programs[name] = {i for i in inputs if i.endswith(".o")}
        self.source_of = {}
        for entry in self.compile_commands():
            words = shlex.split(entry["command"])
            self.source_of[words[words.index("-o") + 1]] = \
                os.path.relpath(entry["file"], self.tree)
        self.includers = {}
        for name in git(self.root, "ls-files", "-z", "--", "*.cpp", "*.hpp").split("\0"):
            if name:
                for match in INCLUDE.finditer((self.tree / name).read_bytes()):
                    included = match.group(1).decode()
                    beside = os.path.normpath(os.path.join(os.path.dirname(name), included))
                    for target in {included, beside}:
                        self.includers.setdefault(target, set()).add(name)

    def compile_commands(self):
        with open(self.build / "compile_commands.json", encoding="utf-8") as file:
            return json.load(file)

    def readers(self, name):
        """The files that include this one, whatever lies between, and itself."""
        seen, new = {name}, [name]
        while new:
            for reader in self.includers.get(new.pop(), ()):
                if reader not in seen:
                    seen.add(reader)
                    new.append(reader)
        return seen

    def who_sees(self, name):
        """Test programs, the nearest first, each with its objects that are compiled from the file."""
        readers = self.readers(name)
        out = []
        near = set(pathlib.PurePath(name).parts)
        for program, objects in self.programs.items():
            seen = {o for o in objects if self.source_of.get(o) in readers}
            if seen:
                own = [pathlib.PurePath(self.source_of[o]).parent.parts for o in objects
                       if self.source_of.get(o, "").startswith("test/") and program.split("/")[-1] in o]
                nearness = max((len(near & set(parts)) for parts in own), default=0)
                out.append((-nearness, len(objects), program, seen))
        return [(program, seen) for _, _, program, seen in sorted(out, key=lambda entry: entry[:3])]

    def arguments_for(self, name, commands):
        """libclang's arguments for a file: its own, or for a header those of one that includes it."""
        by_source = {os.path.relpath(c["file"], self.tree): shlex.split(c["command"]) for c in commands}
        folder = os.path.dirname(name)
        if name in by_source:
            return sites.parse_arguments(by_source[name])
        readers = sorted(self.readers(name) & set(by_source),
                         key=lambda reader: (os.path.dirname(reader) != folder, reader))
        if not readers:
            return None
        return sites.parse_arguments(by_source[readers[0]])

    def find_sites(self, names):
        commands = self.compile_commands()
        if self.programs is None:
            self.read_graph()
        for name in names:
            arguments = self.arguments_for(name, commands)
            if arguments is None:
                self.say(f"{name}: nothing that is built sees it")
                continue
            if name not in self.sites:
                self.sites[name] = sites.find_sites(self.tree / name, name, arguments)
            yield from self.sites[name]

    # --- the unmutated tests ---

    def baseline(self, program):
        """Builds the program as it is and runs its tests: hash, and seconds by test that passes."""
        if program in self.baselines:
            return self.baselines[program]
        self.ninja([program])
        self.numbers = None  # a program's tests are known once it is built
        digest = hash_of(self.build / program)
        kept = self.place / "baselines.json"
        known = json.loads(kept.read_text()) if kept.exists() else {}
        tests = self.tests_of(program)
        seconds = known.get(f"{program} {digest}", {})
        new = [test for test in tests if test not in seconds]
        if new:
            begun = time.monotonic()
            output, _ = self.ctest(new, stops=False)
            seconds |= {test: None for test in new} | passes(output)
            kept.write_text(json.dumps(known | {f"{program} {digest}": seconds}, indent=1))
            self.say(f"  unmutated: {program}: {len(new)} tests, {time.monotonic() - begun:.0f} s")
        failing = [test for test in tests if seconds[test] is None]
        if failing:
            self.say(f"  unmutated: {program}: fail, and are left out: {', '.join(failing)}")
        self.baselines[program] = digest, {t: seconds[t] for t in tests if seconds[t] is not None}
        return self.baselines[program]

    def tests_of(self, program):
        """The names that ctest has for what is run by this program."""
        output, _ = self.command(["ctest", "--test-dir", self.build, "--show-only=json-v1",
                                  *self.label_words()])
        path = str(self.build / program)
        return [test["name"] for test in json.loads(output)["tests"] if path in test.get("command", ())
                and not (self.exclude_tests and re.search(self.exclude_tests, test["name"]))]

    def label_words(self):
        return ["--label-exclude", self.exclude_labels] if self.exclude_labels else []

    def ctest(self, tests, cpu_limit_s=None, stops=True):
        """By numbers: names of hundreds are too long for a regular expression."""
        if self.numbers is None:
            output, _ = self.command(["ctest", "--test-dir", self.build, "--show-only=json-v1"])
            self.numbers = {test["name"]: str(number) for number, test
                            in enumerate(json.loads(output)["tests"], 1)}
        words = ["ctest", "--test-dir", self.build, "--parallel", self.jobs,
                 "--tests-information", "0,0,0," + ",".join(self.numbers[test] for test in tests),
                 "--timeout", WALL_LIMIT_S, "--repeat", "until-pass:2"]  # a hiccup kills nothing
        if stops:
            words.append("--stop-on-failure")
        return self.command(words, None, is_checked=False, cpu_limit_s=cpu_limit_s)

    # --- one mutation ---

    def judge(self, site):
        """Outcome, and by what, or which programs did not notice. The copy is whole again afterwards,
        however this is left."""
        seen_by = self.who_sees(site.file)
        path = self.tree / site.file
        source = path.read_bytes()
        before = self.unmutated_objects(site.file, seen_by)
        tried = []
        for program, objects in seen_by:
            digest, known = self.baseline(program)
            if not known:
                continue
            try:
                path.write_bytes(site.apply(source))
                output, code = self.ninja(sorted(objects), is_checked=False)
                if code != 0:
                    return ledger.NOT_BUILT, first_error(output)
                if before and all(hash_of(self.build / o) == h for o, h in before.items()):
                    return ledger.SAME_CODE, ""
                output, code = self.ninja([program], is_checked=False)
                if code != 0:
                    return ledger.KILLED, f"{program} cannot list its tests"
                if hash_of(self.build / program) == digest:
                    continue  # it links none of what has changed
                tried.append(program.split("/")[-1])
                killer = self.killer(known)
                if killer:
                    return ledger.KILLED, killer
            finally:
                path.write_bytes(source)
        if self.is_quick:
            return ledger.PENDING, ""
        return ledger.SURVIVED, " ".join(tried) or "no test program that sees it"

    def killer(self, known):
        """The test that fails first; the quick ones are asked first."""
        quick = [test for test, seconds in known.items() if seconds <= QUICK_S]
        slow = [test for test, seconds in known.items() if seconds > QUICK_S]
        for tests in filter(None, (quick, [] if self.is_quick else slow)):
            limit_s = self.limit_slack_s + self.limit_factor * max(known[test] for test in tests)
            output, code = self.ctest(tests, limit_s)
            failed = failures(output)
            if failed:
                return failed[0]
            if code != 0:
                raise Trouble(f"ctest says {code}:\n{output[-2000:]}")
        return ""

    def unmutated_objects(self, name, seen_by):
        """Of a source file, what the compiler makes of it as it is: hash by object."""
        if not name.endswith(".cpp"):
            return {}
        own = sorted(set().union(*(objects for _, objects in seen_by)))
        if any(o not in self.object_hashes for o in own):
            self.ninja(own)
            self.object_hashes.update({o: hash_of(self.build / o) for o in own})
        return {o: self.object_hashes[o] for o in own}


def failures(output):
    """Names of tests that failed; of one that did not just fail, how it ended."""
    listed = output.partition("The following tests FAILED:")[2]
    found = re.findall(r"^\s*\d+ - (.+?) \(([^()]*)\)\s*$", listed, re.M)
    return [name if how == "Failed" else f"{name} ({how})" for name, how in found]


def passes(output):
    """Seconds by test."""
    found = re.findall(r"^\s*\d+/\d+ Test\s+#\d+: (\S.*?) \.*\s+Passed\s+([\d.]+) sec", output, re.M)
    return {name: float(seconds) for name, seconds in found}


def first_error(output):
    match = re.search(r"error: (.*)", output)
    return match.group(1)[:120] if match else "does not link"
