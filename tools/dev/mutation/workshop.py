"""Builds and tests mutations: compiles mutated objects in build/mutate and links them with the other
objects of the checkout's build folder. The checkout and its build are only read, so no mutation can
remain there if this process is killed."""

import dataclasses
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
import threading
import time

from . import ledger, sites

INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.M)
GENERATED = "vantage_lcm_gen"  # target of the headers that must exist before a file can be parsed
BUILD_LIMIT_S = 1800.0
TIERS_S = (0.03, 0.5, 3.0, math.inf)  # maximum duration of a test in each tier; the fastest tests run first
QUICK_S = TIERS_S[1]  # longest test with --quick
KILLERS = 12  # maximum number of tests that run first because they noticed a mutation nearby
UNKNOWN_S = 0.1  # assumed duration of a test that has not been timed
SCRIPTED = "vantage"  # program that the tests written as scripts start
WALL_LIMIT_S = 900  # longest time that a test run may use no CPU before it is stopped
LEAST_SHARE = 0.002  # CPU seconds per second; a process that used at least this share is not waiting
# Configuration of a new build: little optimisation, with assertions, without debug information.
CONFIGURATION = ("-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -D_GLIBCXX_ASSERTIONS",
                 "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DVANTAGE_BUILD_TESTS=ON")


class UserError(Exception):
    """Problem that the user must fix first."""


def git(root, *words):
    return subprocess.run(["git", "-C", str(root), *words], check=True, capture_output=True,
                          text=True).stdout


def changed_files(root, but):
    """Returns the changed and untracked files, except those in `but`."""
    out = []
    for entry in git(root, "status", "--porcelain", "-z", "--no-renames",
                     "--untracked-files=all").split("\0"):
        name = entry[3:]
        if name and (root / name).resolve() not in but:
            out.append(name)
    return out


def changed_lines(root, revision):
    """Returns {file: set of the numbers of the lines that differ from a revision}."""
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
    """Returns the C++ files at or below a path."""
    names = [name for name in git(root, "ls-files", "-z", "--", path).split("\0")
             if name.endswith((".cpp", ".hpp"))]
    if not path.startswith("test"):
        names = [name for name in names if not name.startswith("test/")]
    return names


def processor_time(session):
    """Returns the processor time in s of all processes of a session (ended children included), and true if one of these
    processes is ready to run."""
    ticks = 0
    wants_more = False
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue  # the process has ended
        if int(fields[3]) == session:
            ticks += sum(int(field) for field in fields[11:15])
            wants_more = wants_more or fields[0] == "R"
    return ticks / os.sysconf("SC_CLK_TCK"), wants_more


def output_of(process, limit_s):
    """Waits for a process and returns its output. Raises TimeoutExpired if the process has not used the processor for
    `limit_s`. Wall time alone is not checked, because a process may get little time on a busy machine."""
    used_s = 0.0
    while True:
        try:
            return process.communicate(timeout=limit_s)[0]
        except subprocess.TimeoutExpired:
            before_s = used_s
            used_s, wants_more = processor_time(process.pid)
            if used_s - before_s < LEAST_SHARE * limit_s and not wants_more:
                raise


def hash_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def has_every_file_alone(build):
    """Returns true if `build` is a build that compiles each file separately (no unity build). This is required because a
    mutated object replaces the object of one file."""
    cache = build / "CMakeCache.txt"
    return (build / "build.ninja").exists() and not (
        cache.exists() and "VANTAGE_UNITY:BOOL=ON" in cache.read_text())


class Workshop:
    """The unmutated sources, a build of them, and the known facts about its tests."""

    def __init__(self, root, build=None, exclude_labels="", exclude_tests="", only="", quick_s=None,
                 jobs=1, limit_factor=5.0, limit_slack_s=5.0, scripts="", say=print):
        self.root = pathlib.Path(root)
        self.place = self.root / "build" / "mutate"
        release = self.root / "build" / "release"
        self.is_given = build is not None  # a given build is used without updating it
        self.build = self.root / build if build else \
            release if has_every_file_alone(release) else self.place / "build"
        self.exclude_labels = exclude_labels
        self.exclude_tests = exclude_tests
        self.only = only
        self.quick_s = quick_s  # longer tests are not run, so mutations that survive remain pending
        self.scripts = scripts
        self.jobs = jobs
        self.limit_factor = limit_factor
        self.limit_slack_s = limit_slack_s
        self.say = say
        self.programs = None
        self.scripted = None  # (program that scripts start, its objects)
        self.sites = {}
        self.tests = {}
        self.sound = {}
        self.seconds = self.read_seconds()
        self.links = {}
        self.compiled = {}
        self.running = set()
        self.is_stopped = False
        self.mutex = threading.RLock()  # guards the data that all mutations share

    # --- the build ---

    def open(self, is_for_tests):
        """Opens a session. Only one at a time is permitted, because sessions would disturb each other's timings."""
        self.place.mkdir(parents=True, exist_ok=True)
        self.lock = open(self.place / "lock", "w")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise UserError("another process is using build/mutate; wait until it ends") from None
        shutil.rmtree(self.place / "work", ignore_errors=True)
        if not (self.build / "build.ninja").exists():
            self.say(f"configuring {self.build}")
            self.command(["cmake", "-S", self.root, "-B", self.build, *CONFIGURATION])
        if is_for_tests:
            self.read_graph()
        elif not self.is_given and self.targets().get(GENERATED):
            self.ninja([GENERATED])

    # --- commands, which end with this process ---

    def command(self, words, limit_s=BUILD_LIMIT_S, is_checked=True, cpu_limit_s=None, cwd=None, env=None):
        """Runs a command. Returns its output and exit code; the code is None if the command was killed because it used no CPU
        for `limit_s`. `cpu_limit_s` limits the CPU time of each process, because wall time depends on the machine's load."""
        def limit():
            if cpu_limit_s is not None:
                resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(cpu_limit_s),) * 2)

        if self.is_stopped:
            raise UserError("stopped")
        process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace", cwd=cwd,
                                   env=env, start_new_session=True, preexec_fn=limit)
        code = None
        self.running.add(process)
        try:
            if self.is_stopped:  # stop() was called before the process was in `running`
                os.killpg(process.pid, signal.SIGKILL)
            output = output_of(process, limit_s)
            code = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
        finally:
            self.running.discard(process)
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        if self.is_stopped:
            raise UserError("stopped")
        if is_checked and code != 0:
            raise UserError(f"{' '.join(map(str, words))}\n{output[-3000:]}")
        return output, code

    def stop(self):
        """Kills the commands of other threads, whose results are then invalid."""
        self.is_stopped = True
        for process in list(self.running):
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def ninja(self, targets):
        if not self.is_given:
            self.command(["ninja", "-j", self.jobs, "-C", self.build, *targets])

    # --- dependencies ---

    def targets(self):
        """Returns {target: rule} of the build."""
        out = {}
        for line in self.command(["ninja", "-C", self.build, "-t", "targets", "all"])[0].splitlines():
            name, _, rule = line.partition(": ")
            out[name] = rule
        return out

    def read_graph(self):
        """Reads the objects of each test program, the source and command of each object, and the includes."""
        self.ninja(["build.ninja"])
        kept = self.place / "graph.json"
        digest = hash_of(self.build / "build.ninja")
        graph = json.loads(kept.read_text()) if kept.exists() else {}
        if graph.get("of") != digest:
            graph = {"of": digest, "programs": {}}
            graph["all"] = [name for name, rule in self.targets().items()
                            if rule.startswith("CXX_EXECUTABLE_LINKER") and
                            (name.endswith("_test") or name.split("/")[-1] == SCRIPTED)]
        self.programs = {}
        is_asked = re.compile(self.only).search
        for name in [n for n in graph["all"] if n.split("/")[-1] == SCRIPTED or is_asked(n)]:
            if name not in graph["programs"]:
                inputs = self.command(["ninja", "-C", self.build, "-t", "inputs", name])[0].splitlines()
                graph["programs"][name] = sorted(i for i in inputs if i.endswith(".o"))
            self.programs[name] = set(graph["programs"][name])
        self.scripted = next(((n, self.programs.pop(n)) for n in list(self.programs)
                              if n.split("/")[-1] == SCRIPTED), None)
        kept.write_text(json.dumps(graph))
        self.source_of = {}
        self.command_of = {}
        for entry in self.compile_commands():
            words = shlex.split(entry["command"])
            made = words[words.index("-o") + 1]
            self.source_of[made] = os.path.relpath(entry["file"], self.root)
            self.command_of[made] = words
        self.includers = {}
        for name in git(self.root, "ls-files", "-z", "--", "*.cpp", "*.hpp").split("\0"):
            if name and (self.root / name).exists():
                for match in INCLUDE.finditer((self.root / name).read_bytes()):
                    included = match.group(1).decode()
                    beside = os.path.normpath(os.path.join(os.path.dirname(name), included))
                    for target in {included, beside}:
                        self.includers.setdefault(target, set()).add(name)

    def compile_commands(self):
        with open(self.build / "compile_commands.json", encoding="utf-8") as file:
            return json.load(file)

    def readers(self, name):
        """Returns the file `name` and all files that include it directly or indirectly."""
        seen, new = {name}, [name]
        while new:
            for reader in self.includers.get(new.pop(), ()):
                if reader not in seen:
                    seen.add(reader)
                    new.append(reader)
        return seen

    def programs_for(self, name):
        """Returns the test programs that depend on the file, each with its dependent objects. Programs with tests in
        the same or a near folder come first."""
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

    def arguments_for(self, name):
        """Returns libclang's arguments for a file, or for a header the arguments for a file that includes it; None if
        there are none."""
        by_source = {source: self.command_of[made] for made, source in self.source_of.items()}
        folder = os.path.dirname(name)
        if name in by_source:
            return sites.parse_arguments(by_source[name])
        readers = sorted(self.readers(name) & set(by_source),
                         key=lambda reader: (os.path.dirname(reader) != folder, reader))
        if not readers:
            return None
        return sites.parse_arguments(by_source[readers[0]])

    def find_sites(self, names):
        if self.programs is None:
            self.read_graph()
        for name in names:
            if name not in self.sites:
                arguments = self.arguments_for(name)
                if arguments is None:
                    self.say(f"{name}: no built program contains this file")
                self.sites[name] = self.kept_sites(name, arguments) if arguments is not None else []
            yield from self.sites[name]

    def kept_sites(self, name, arguments):
        """Returns the sites of a file from a cache keyed by content, because libclang needs seconds per file."""
        finder = pathlib.Path(sites.__file__).read_bytes()
        text = (self.root / name).read_bytes()
        key = hashlib.sha256(b"\0".join((name.encode(), finder, text))).hexdigest()[:24]
        kept = self.place / "sites" / key
        if kept.exists():
            return [sites.Site(**{**fields, "replacement": fields["replacement"].encode()})
                    for fields in json.loads(kept.read_text())]
        found = sites.find_sites(self.root / name, name, arguments)
        kept.parent.mkdir(exist_ok=True)
        unfinished = kept.with_suffix(f".{os.getpid()}")
        unfinished.write_text(json.dumps([{**dataclasses.asdict(site), "replacement": site.replacement.decode()}
                                          for site in found]))
        os.replace(unfinished, kept)
        return found

    # --- the unmutated tests ---

    def known(self, program):
        """Returns the tests of a program with their last known durations. Does not run the tests."""
        with self.mutex:
            if program not in self.tests:
                self.ninja([program])
                self.tests[program] = self.tests_of(program)
            return [test.timed(self.seconds.get(test.name, UNKNOWN_S)) for test in self.tests[program]]

    def read_seconds(self):
        """Returns the durations of tests from ctest's records and from earlier sessions."""
        out = {}
        notes = self.build / "Testing" / "Temporary" / "CTestCostData.txt"
        if notes.exists():
            for line in notes.read_text().partition("\n---")[0].splitlines():
                name, runs, seconds = line.rsplit(" ", 2)
                if runs != "0":
                    out[name] = float(seconds)
        kept = self.place / "seconds.json"
        return out | (json.loads(kept.read_text()) if kept.exists() else {})

    def is_sound(self, program, test):
        """Returns true if a test passes without mutation. Each test that noticed a mutation is checked only once."""
        with self.mutex:
            if test.name not in self.sound:
                begun = time.monotonic()
                output, code = self.try_tests(self.build / program, [test], WALL_LIMIT_S)
                self.sound[test.name] = code == 0
                self.seconds[test.name] = passes(output).get(test.key, time.monotonic() - begun)
                if code != 0:
                    self.say(f"  {test.name} fails without a mutation and is left out")
            return self.sound[test.name]

    def tests_of(self, program):
        """Returns the tests of ctest that run this program."""
        out = []
        for entry in self.ctest_tests():
            words = entry.get("command", ())
            at = next((i for i, word in enumerate(words) if word.endswith(f"/{program}")), None)
            if at is not None and not (self.exclude_tests and re.search(self.exclude_tests, entry["name"])):
                chosen = [w.partition("=")[2] for w in words if w.startswith("--gtest_filter=")]
                out.append(Test(entry["name"], chosen[0] if chosen else "", place_of(entry), before=words[:at]))
        return out

    def ctest_tests(self):
        """Returns ctest's description of all tests."""
        told, _ = self.command(["ctest", "--test-dir", self.build, "--show-only=json-v1",
                                *(["--label-exclude", self.exclude_labels] if self.exclude_labels else [])])
        return json.loads(told)["tests"]

    def script_tests(self):
        """Returns the tests that are scripts and start SCRIPTED, the fastest first. Scripts run after all other tests."""
        with self.mutex:
            if SCRIPTED not in self.tests:
                chosen = re.compile(self.scripts) if self.scripts else None
                self.tests[SCRIPTED] = [
                    Test(entry["name"], "", place_of(entry), before=entry.get("command", ()))
                    for entry in self.ctest_tests() if chosen and chosen.search(entry["name"])]
                if self.tests[SCRIPTED]:
                    self.ninja([self.scripted[0]])
            return sorted(self.tests[SCRIPTED], key=lambda test: self.seconds.get(test.name, UNKNOWN_S))

    def try_tests(self, path, tests, cpu_limit_s=None):
        """Runs a group of tests in one process until the first failure. Returns its output and exit code."""
        words = [*tests[0].before, path]
        if tests[0].filter:
            words += ["--gtest_filter=" + ":".join(t.filter for t in tests)]
            words += ["--gtest_fail_fast"] if cpu_limit_s is not None else []
        scratch = self.place / "work" / f"scratch{threading.get_ident()}"
        scratch.mkdir(parents=True, exist_ok=True)
        return self.command(words, WALL_LIMIT_S, is_checked=False, cpu_limit_s=cpu_limit_s,
                            cwd=tests[0].place, env={**os.environ, "TMPDIR": str(scratch)})

    # --- one mutation ---

    def judge(self, site, killers=()):
        """Returns the outcome, and the test that noticed the mutation or the programs that did not notice it."""
        place = self.place / "work" / site.id
        try:
            return self.judge_in(place, site, killers)
        finally:
            shutil.rmtree(place, ignore_errors=True)
            with self.mutex:
                (self.place / "seconds.json").write_text(json.dumps(self.seconds, indent=0))

    def judge_in(self, place, site, killers):
        tried = []
        made = {}  # path of the mutated object, by object
        for program, objects in self.programs_for(site.file):
            known = self.known(program)
            if not known:
                continue
            for wanted in sorted(objects - set(made)):
                made[wanted] = place / f"{len(made)}.o"
                output, code = self.compile(wanted, made[wanted], place / "sources", site.file,
                                            site.apply((self.root / site.file).read_bytes()))
                if code != 0:
                    return ledger.NOT_BUILT, first_error(output)
            path = place / program.split("/")[-1]
            output, code = self.link(program, {o: made[o] for o in objects}, path)
            if code != 0:
                return ledger.NOT_BUILT, first_error(output)
            tried.append(path.name)
            killer = self.killer(program, path, known, killers)
            path.unlink()
            if killer:
                return ledger.KILLED, killer
            # A killed mutation must have changed the object, so only other mutations are compared with the unmutated object.
            if len(tried) == 1 and site.file.endswith(".cpp") and all(
                    hash_of(made[o]) == self.unmutated(o, site) for o in objects):
                return ledger.SAME_CODE, ""
        if self.quick_s is not None:
            return ledger.PENDING, ""
        return self.judge_by_scripts(place, site, made, tried)

    def judge_by_scripts(self, place, site, made, tried):
        """Runs scripts with the mutated SCRIPTED program, to judge a mutation that no test program noticed."""
        name, inputs = self.scripted or ("", set())
        readers = self.readers(site.file)
        objects = {o for o in inputs if self.source_of.get(o) in readers}
        scripts = self.script_tests() if objects else []
        if scripts:
            folder = place / "bin"
            folder.mkdir(parents=True)
            for built in (self.build / name).parent.iterdir():
                (folder / built.name).symlink_to(built)
            path = folder / SCRIPTED
            path.unlink()
            for wanted in sorted(objects - set(made)):
                made[wanted] = place / f"{len(made)}.o"
                output, code = self.compile(wanted, made[wanted], place / "sources", site.file,
                                            site.apply((self.root / site.file).read_bytes()))
                if code != 0:
                    return ledger.NOT_BUILT, first_error(output)
            output, code = self.link(name, {o: made[o] for o in objects}, path)
            if code != 0:
                return ledger.NOT_BUILT, first_error(output)
            tried.append(SCRIPTED)
        for test in scripts:
            # Runs the script without mutation first, which also measures its duration.
            if not self.is_sound_script(test):
                continue
            limit_s = self.limit_slack_s + self.limit_factor * self.seconds[test.name]
            if all(self.try_script(test, folder, limit_s) != 0 for _ in range(2)):
                return ledger.KILLED, test.name
        return ledger.SURVIVED, " ".join(tried) or "no test program contains the file"

    def try_script(self, test, folder=None, cpu_limit_s=None):
        """Runs a script with the programs of another folder. Returns the exit code."""
        there = str((self.build / self.scripted[0]).parent)
        words = [word.replace(there, str(folder or there)) for word in test.before]
        return self.command(words, WALL_LIMIT_S, is_checked=False, cpu_limit_s=cpu_limit_s, cwd=test.place)[1]

    def is_sound_script(self, test):
        with self.mutex:
            if test.name not in self.sound:
                begun = time.monotonic()
                self.sound[test.name] = self.try_script(test) == 0
                self.seconds[test.name] = time.monotonic() - begun  # upper bound for each of its processes
                if not self.sound[test.name]:
                    self.say(f"  {test.name} fails without a mutation and is left out")
            return self.sound[test.name]

    def compile(self, wanted, made, sources, name, text, options=()):
        """Compiles an object after replacing the file `name`, its source or a header, by `text`."""
        words = list(self.command_of[wanted])
        words[words.index("-o") + 1] = made
        overlay = sources / name
        overlay.parent.mkdir(parents=True, exist_ok=True)
        overlay.write_bytes(text)
        source = self.source_of[wanted]
        if source == name:
            words[words.index("-c") + 1] = overlay
        beside = [f"-iquote{(sources / source).parent}", f"-iquote{(self.root / source).parent}"]
        # Puts the mutated header first in the search path, so that the compiler finds it.
        words[1:1] = [*beside, f"-I{sources}", f"-ffile-prefix-map={sources}={self.root}", *options]
        return self.command(words, is_checked=False, cwd=self.build)

    def unmutated(self, wanted, site):
        """Returns the hash of the object that is compiled with the same command without mutation."""
        with self.mutex:
            if wanted not in self.compiled:
                place = self.place / "work" / "unmutated"
                made = place / "o"
                self.compile(wanted, made, place / "sources", site.file, (self.root / site.file).read_bytes())
                self.compiled[wanted] = hash_of(made)
                shutil.rmtree(place)
            return self.compiled[wanted]

    def link(self, program, made, path):
        """Links a program with the mutated objects, which precede the archives with the unmutated ones."""
        if program not in self.links:
            last = self.command(["ninja", "-C", self.build, "-t", "commands", program])[0].splitlines()[-1]
            step = next(s for s in last.split(" && ") if f" -o {program}" in s)
            self.links[program] = shlex.split(step)
        words = [str(made.get(word, word)) for word in self.links[program]]
        at = words.index("-o") + 1
        words[at] = str(path)
        words[at + 1:at + 1] = [str(m) for o, m in sorted(made.items()) if o not in self.links[program]]
        return self.command(words, is_checked=False, cwd=self.build)

    def killer(self, program, path, known, killers):
        """Returns the first test that fails, or "". Tests in `killers`, which noticed mutations nearby, run first."""
        if self.quick_s is not None:
            known = [t for t in known if t.seconds <= self.quick_s]
        old = [t for k in killers for t in known if t.name == k and t.seconds <= TIERS_S[-2]][:KILLERS]
        rest = [t for t in known if t not in old]
        tiers = [old]
        for low, high in zip((-1.0, *TIERS_S), TIERS_S):
            tiers.append([t for t in rest if low < t.seconds <= high])
        for tests in tiers:
            for group in by_kind(tests):
                found = self.failing(program, path, group)
                if found:
                    return found
        return ""

    def failing(self, program, path, group):
        """Returns the first test of a group that fails twice (to exclude sporadic failures) and passes without mutation."""
        while group:
            limit_s = self.limit_slack_s + self.limit_factor * sum(t.seconds for t in group)
            output, code = self.try_tests(path, group, limit_s)
            passed = passes(output)
            with self.mutex:
                self.seconds |= {t.name: passed[t.key] for t in group if t.key in passed}
            if code == 0:
                return ""
            at = next((i for i, t in enumerate(group) if t.key == last_begun(output)), 0) \
                if group[0].filter else 0
            test = group[at]
            limit_s = self.limit_slack_s + self.limit_factor * test.seconds
            _, code = self.try_tests(path, [test], limit_s)
            if code != 0 and self.is_sound(program, test):
                takes_s = self.seconds.get(test.name, 0.0)
                if code in (None, -9, -24) and takes_s > test.seconds:  # the limit was too short
                    _, code = self.try_tests(path, [test], self.limit_slack_s + self.limit_factor * takes_s)
            if code != 0 and self.is_sound(program, test):
                how = "" if code == 1 else " (does not end)" if code in (None, -9, -24) else " (crashes)"
                return test.name + how
            # Continues with the tests that have not run yet.
            group = [t for t in group if t.key not in passed and t is not test]
        return ""


class Test:
    """A test of ctest, with its --gtest_filter (empty: the whole program) and the command before its program
    (e.g. for a separate network namespace)."""

    def __init__(self, name, chosen, place, seconds=0.0, before=()):
        self.name, self.filter, self.place, self.seconds, self.before = name, chosen, place, seconds, tuple(before)
        self.key = chosen or name

    def timed(self, seconds):
        return Test(self.name, self.filter, self.place, seconds, self.before)

    def run_by(self, words):
        """Returns the same test with a command before its program."""
        return Test(self.name, self.filter, self.place, self.seconds, (*self.before, *words))


def place_of(entry):
    """Returns the working directory of a test."""
    return next((p["value"] for p in entry["properties"] if p["name"] == "WORKING_DIRECTORY"), None)


def by_kind(tests):
    """Returns groups of tests that one process can run."""
    chosen = {}
    for test in tests:
        if test.filter:
            chosen.setdefault(test.before, []).append(test)
    return list(chosen.values()) + [[t] for t in tests if not t.filter]


def last_begun(output):
    found = re.findall(r"^\[ RUN      \] (\S+)", output, re.M)
    failed = re.findall(r"^\[  FAILED  \] ([^\s,]+),? ?.*\(\d+ ms\)$", output, re.M)
    return failed[0] if failed else found[-1] if found else ""


def passes(output):
    """Returns the durations in s of the tests that passed or were skipped."""
    found = re.findall(r"^\[       OK \] (\S+) \((\d+) ms\)$", output, re.M)
    return {name: int(ms) / 1e3 for name, ms in found} | \
        {name: 0.0 for name in re.findall(r"^\[  SKIPPED \] (\S+) \(\d+ ms\)$", output, re.M)}


def first_error(output):
    match = re.search(r"error: (.*)", output)
    return match.group(1)[:120] if match else "does not link"
