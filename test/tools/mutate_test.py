#!/usr/bin/env python3
"""mutate_test.py SOURCE_DIR: tools/dev/mutate finds each kind of bug, draws the same sample again, distinguishes
mutations that a test detects from others, continues where it was stopped, and restores the checkout.

It runs on a small project: a library of one function, and a test of it that checks too little.
Exit code 77 if libclang for Python is missing."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else ".").resolve()
sys.path.insert(0, str(SOURCE / "tools" / "dev"))
from mutation import ledger, sites, sweep, workshop  # noqa: E402

MUTATE = SOURCE / "tools" / "dev" / "mutate"
ARGUMENTS = ["-std=c++20"]


def changes(text):
    """Returns (operator, before, after) of each site of a source text."""
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as file:
        file.write(text)
        file.flush()
        return {(s.operator, s.before, s.after) for s in sites.find_sites(file.name, "a.cpp", ARGUMENTS)}


class Operators(unittest.TestCase):
    def expect(self, text, *wanted):
        found = changes(text)
        for change in wanted:
            self.assertIn(change, found)
        return found

    def test_comparison_is_inverted_and_its_limit_moved(self):
        self.expect("bool f(int a, int b) { return a < b; }",
                    ("comparison", "a < b", "a > b"), ("comparison", "a < b", "a <= b"))

    def test_floating_point_limit_is_not_mutated(self):
        found = self.expect("bool f(double a) { return a < 1.5; }", ("comparison", "a < 1.5", "a > 1.5"))
        self.assertNotIn(("comparison", "a < 1.5", "a <= 1.5"), found)

    def test_comparison_of_instants_is_found_despite_rewriting(self):
        self.expect("#include <chrono>\nusing T = std::chrono::steady_clock::time_point;\n"
                    "bool f(T a, T b) { return a < b; }\nbool g(T a, T b) { return a != b; }",
                    ("comparison", "a < b", "a > b"), ("comparison", "a < b", "a <= b"),
                    ("comparison", "a != b", "a == b"))

    def test_negation_is_removed(self):
        self.expect("bool f(bool a) { return !a; }", ("comparison", "!a", "(a)"))

    def test_sign_is_changed(self):
        self.expect("double f(double a, double b) { a += b; return -a - b; }",
                    ("sign", "-a - b", "-a + b"), ("sign", "-a", "(a)"), ("sign", "a += b", "a -= b"))

    def test_sign_of_texts_and_pointers_is_not_mutated(self):
        found = changes("#include <string>\n#include <vector>\n"
                        "std::string f(const std::string& a) { return a + 'x'; }\n"
                        "int g(const std::vector<int>& v) { return *(v.begin() + 1); }")
        self.assertEqual([], [c for c in found if c[0] in ("sign", "term")])

    def test_term_is_removed(self):
        self.expect("bool f(bool a, bool b, int c) { return a && b && (c ? a : b); }",
                    ("term", "a && b", "(a)"), ("term", "a && b", "(b)"),
                    ("term", "c ? a : b", "(a)"), ("term", "c ? a : b", "(b)"))
        self.expect("double f(double a, double b) { return a - b * 2; }",
                    ("term", "a - b * 2", "(a)"), ("term", "a - b * 2", "(-b * 2)"),
                    ("term", "b * 2", "(b)"))

    def test_constant_is_changed(self):
        self.expect("struct S { double a = 0.5; };\nint f(int a) { return a + 3; }",
                    ("constant", "double a = 0.5", "double a = (2 * 0.5)"),
                    ("constant", "double a = 0.5", "double a = (0.5 / 2)"),
                    ("constant", "a + 3", "a + 6"), ("constant", "a + 3", "a + 1"))

    def test_min_and_max_are_swapped(self):
        self.expect("#include <algorithm>\nint f(int a, int b) { return std::min(a, std::clamp(b, 0, 9)); }",
                    ("minmax", "std::min(a, std::clamp(b, 0, 9))", "std::max(a, std::clamp(b, 0, 9))"),
                    ("minmax", "std::clamp(b, 0, 9)", "(b)"))

    def test_limits_of_types_are_not_mutated(self):
        found = changes("#include <limits>\nint f() { return std::numeric_limits<int>::max(); }")
        self.assertEqual(set(), found)

    def test_abs_is_removed(self):
        self.expect("#include <cmath>\ndouble f(double a) { return std::abs(a); }",
                    ("abs", "std::abs(a)", "(a)"))

    def test_index_is_changed(self):
        self.expect("#include <vector>\nint f(const std::vector<int>& v, int i) { int w[3] = {}; return v[i] + w[0]; }",
                    ("index", "v[i]", "v[i + 1]"), ("index", "v[i]", "v[i - 1]"),
                    ("index", "w[0]", "w[0 + 1]"))
        self.expect("struct P { double x() const; double y() const; };\ndouble f(P p) { return p.x(); }",
                    ("index", "p.x()", "p.y()"))

    def test_only_early_returns_are_removed(self):
        found = self.expect("int f(bool a) { if (a) { return 1; } return 2; }",
                            ("return", "if (a) { return 1; }", "if (a) { ; }"))
        self.assertEqual(1, len([c for c in found if c[0] == "return"]))

    def test_continue_is_removed(self):
        self.expect("void g(); void f() { for (int i = 0; i < 3; ++i) { if (i == 1) { continue; } g(); } }",
                    ("return", "if (i == 1) { continue; }", "if (i == 1) { ; }"))

    def test_assignment_is_removed(self):
        self.expect("#include <optional>\n#include <vector>\n"
                    "void f(int& n, std::optional<int>& o, std::vector<int>& v) { n = 0; ++n; o.reset(); v.clear(); }",
                    ("reset", "n = 0", ""), ("reset", "++n", ""), ("reset", "o.reset()", ""),
                    ("reset", "v.clear()", ""))

    def test_arguments_of_equal_type_are_swapped(self):
        found = self.expect("int g(int, int, bool);\nstruct S { int a; int b; };\n"
                            "int f(int a, int b) { S s{a, b}; return g(a, b, true) + s.a; }",
                            ("swap", "g(a, b, true)", "g(b, a, true)"), ("swap", "{a, b}", "{b, a}"))
        self.assertEqual(2, len([c for c in found if c[0] == "swap"]))

    def test_unit_is_changed(self):
        self.expect("struct S { double age_s; };\ndouble f(S s, double way_m) { return s.age_s * 1e-3 + way_m; }",
                    ("unit", "s.age_s", "(1e-3 * s.age_s)"), ("unit", "way_m", "(1e3 * way_m)"),
                    ("unit", "s.age_s * 1e-3", "s.age_s * 1.0"))

    def test_declarations_and_messages_are_not_mutated(self):
        self.assertEqual(set(), changes(
            "// a < b\nnamespace spdlog { void info(const char*, int); }\n"
            "static_assert(1 + 1 == 2);\nenum E { kA = 3 };\ntemplate <int N> struct T { int v[N + 4]; };\n"
            "int f(int a = 7);\n#define TWICE(a) (2 * (a))\n"
            "int g(E e) { T<5> t; (void)t; spdlog::info(\"x\", 3); switch (e) { case kA: break; } return TWICE(e); }"))

    def test_header_is_parsed_as_included(self):
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / "a.hpp").write_text("#pragma once\nstruct A { int f(int a); };\n#include \"a_impl.hpp\"\n")
            (place / "a_impl.hpp").write_text(
                "#pragma once\n#include \"a.hpp\"\ninline int A::f(int a) { return a + 2; }\n")
            self.assertIn(("sign", "a + 2", "a - 2"), {
                (s.operator, s.before, s.after)
                for s in sites.find_sites(place / "a_impl.hpp", "a_impl.hpp", ARGUMENTS)})

    def test_slow_constant_evaluation_is_found(self):
        self.expect("constexpr int last() { int s = 0; for (int i = 0; i < 600000; ++i) { s = i + 1; } return s; }\n"
                    "static_assert(last() == 600000);\n", ("sign", "i + 1", "i - 1"))


class Ids(unittest.TestCase):
    def ids(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".cpp") as file:
            file.write(text)
            file.flush()
            return [s.id for s in sites.find_sites(file.name, "a.cpp", ARGUMENTS)]

    def test_are_unchanged_when_other_functions_change(self):
        mine = "int f(int a, int b) { return a < b ? a + 2 : a + 2; }\n"
        before = self.ids(mine)
        self.assertEqual(len(before), len(set(before)))
        self.assertEqual(before, self.ids("int g(int a) { return a * 3; }\n\n" + mine)[-len(before):])


def site(number, operator):
    return sites.Site(f"{number:08x}", "a.cpp", number, operator, "a", "b", number, number + 1, b"b")


class Draws(unittest.TestCase):
    found = [site(n, "term" if n % 10 else "abs") for n in range(1, 200)]

    def test_seed_determines_the_draw_for_any_order_of_sites(self):
        one = ledger.draw(self.found, 30, 1, "core")
        self.assertEqual(one, ledger.draw(self.found[::-1], 30, 1, "core"))
        self.assertNotEqual(one, ledger.draw(self.found, 30, 2, "core"))

    def test_kinds_are_equally_frequent_while_available(self):
        drawn = ledger.draw(self.found, 30, 1, "core")
        self.assertEqual(15, sum(1 for s in drawn if s.operator == "abs"))
        self.assertEqual(30, len({s.id for s in drawn}))

    def test_draw_is_limited_to_the_number_of_sites(self):
        self.assertEqual(len(self.found), len(ledger.draw(self.found, 1000, 1, "core")))


class Builds(unittest.TestCase):
    def test_unity_builds_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder)
            self.assertFalse(workshop.has_every_file_alone(build))
            (build / "build.ninja").touch()
            self.assertTrue(workshop.has_every_file_alone(build))
            cache = build / "CMakeCache.txt"
            cache.write_text("VANTAGE_UNITY:BOOL=OFF\n")
            self.assertTrue(workshop.has_every_file_alone(build))
            cache.write_text("VANTAGE_UNITY:BOOL=ON\n")
            self.assertFalse(workshop.has_every_file_alone(build))


class Commands(unittest.TestCase):
    def code_of(self, words, **limits):
        with tempfile.TemporaryDirectory() as folder:
            return workshop.Workshop(folder).command(words, is_checked=False, **limits)[1]

    def test_waiting_commands_end_and_slow_ones_do_not(self):
        busy = "import time\nwhile time.process_time() < 1.0: pass\nprint('done')"
        # Runs as a child process of a shell, as a test of ctest may do.
        words = ["sh", "-c", f'{sys.executable} -c "$0"; exit $?', busy]
        self.assertEqual(0, self.code_of(words, limit_s=0.2))
        self.assertIsNone(self.code_of(["sleep", "600"], limit_s=1.0))

    def test_commands_end_at_their_cpu_limit(self):
        self.assertIn(self.code_of([sys.executable, "-c", "while True: pass"], limit_s=0.2, cpu_limit_s=1.0), (-9, -24))


class Ledgers(unittest.TestCase):
    def test_first_outcome_is_kept_and_counted(self):
        with tempfile.TemporaryDirectory() as folder:
            book = ledger.Ledger(pathlib.Path(folder) / "ledger.jsonl")
            book.add([site(n, "abs") for n in range(4)], "core", 1)
            self.assertEqual(0, book.add([site(2, "abs")], "core", 2))  # a second addition has no effect
            for row, outcome in zip(book.rows, (ledger.KILLED, ledger.SURVIVED, ledger.SURVIVED, ledger.NOT_BUILT)):
                book.settle(row, outcome, "abc")
            book.settle(book.rows[1], ledger.KILLED, "def", by="core.Suite.Case")
            book.settle(book.rows[2], ledger.EQUIVALENT, "def", reason="is never read")
            book.save()
            read = ledger.Ledger(book.path)
            self.assertEqual(book.rows, read.rows)
            self.assertEqual("survived", read.rows[1]["first"])
            self.assertEqual("| core | 4 | 2 | 0 | 1 | 100 % | 67 % | 1 | 0 |",
                             ledger.table(read.rows, "draw").splitlines()[2])


class Sweeping(unittest.TestCase):
    SOURCE = b"void f(int& n) { n = 0; ++n; }\nint g(int n) { return -n; }\n"

    def setUp(self):
        with tempfile.NamedTemporaryFile(suffix=".cpp") as file:
            file.write(self.SOURCE)
            file.flush()
            self.found = sites.find_sites(file.name, "a.cpp", ARGUMENTS)
            self.bodies = sites.find_bodies(file.name, "a.cpp", ARGUMENTS)
        self.text, self.owners = sweep.text_of(self.SOURCE, self.bodies, list(enumerate(self.found)))

    def result(self, chosen):
        """Runs f(n), then g(n) + 10, with n = 5 and each chosen mutation. Returns the exit codes."""
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "a.cpp"
            source.write_bytes(self.text + b"int main() { int n = 5; f(n); return g(n) + 10; }\n" +
                               sweep.CHOOSER.encode().replace(b'extern "C" ', b""))
            subprocess.run(["c++", "-o", f"{folder}/a", str(source)], check=True)
            return [subprocess.run([f"{folder}/a"], env={sweep.VARIABLE: str(number)}).returncode
                    for number in chosen]

    def test_only_the_body_of_the_mutation_is_run(self):
        expected = {"n = 0": 10 - 6, "++n": 10 - 0, "-n": 10 + 1}
        self.assertEqual(set(expected), {site.before for site in self.found})
        self.assertEqual([expected[site.before] for site in self.found] + [9],
                         self.result([*range(len(self.found)), -1]))

    def test_lines_belong_to_their_mutation(self):
        lines = self.text.split(b"\n")
        for number, site in enumerate(self.found):
            at = [i for i, line in enumerate(lines, 1) if f"== {number})".encode() in line]
            self.assertEqual({number}, sweep.culprits([at[0], at[0] + 1], self.owners))
        self.assertEqual(set(), sweep.culprits([1, 2, len(lines)], self.owners))

    def test_compile_time_code_is_unchanged(self):
        with tempfile.NamedTemporaryFile(suffix=".cpp") as file:
            file.write(b"constexpr int f() { return 3; }\nstruct S { int g() { return 4; } };\n")
            file.flush()
            bodies = sites.find_bodies(file.name, "a.cpp", ARGUMENTS)
        self.assertEqual([False], [body.is_void for body in bodies])
        self.assertGreater(bodies[0].begin, 32)


TOY = {
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(toy LANGUAGES CXX)
enable_testing()
add_library(toy toy/toy.cpp)
target_include_directories(toy PUBLIC ${PROJECT_SOURCE_DIR})
foreach(name toy other slow)
  add_executable(${name}_test test/${name}_test.cpp)
  add_test(NAME ${name}.runs COMMAND ${name}_test)
endforeach()
target_link_libraries(toy_test PRIVATE toy)
target_link_libraries(slow_test PRIVATE toy)
set_tests_properties(slow.runs PROPERTIES LABELS long)
add_library(far far/far.cpp)
target_include_directories(far PUBLIC ${PROJECT_SOURCE_DIR})
add_executable(far_test test/far_test.cpp)
target_link_libraries(far_test PRIVATE far)
add_test(NAME far.runs COMMAND env ELSEWHERE=1 $<TARGET_FILE:far_test>)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
add_executable(vantage test/vantage.cpp)
target_link_libraries(vantage PRIVATE far)
add_test(NAME guard.table COMMAND sh ${PROJECT_SOURCE_DIR}/test/guard.sh $<TARGET_FILE_DIR:vantage>)
""",
    ".gitignore": "build/\n",
    "toy/toy.hpp": "#pragma once\nint clipped(int value, int most);\nbool ends(int count);\nint one_more(const int& from);\n",
    "toy/toy.cpp": """#include "toy/toy.hpp"

int clipped(int value, int most) {
  if (value > most) {
    return most;
  }
  return value;
}

bool ends(int count) {
  int left = count;
  while (left != 0) {
    --left;
  }
  return left == 0;
}

int sum(int& to, const int& from) { return to + from; }

int one_more(const int& from) {
  int to = 1;
  return sum(to, from);
}
""",
    "far/far.hpp": "#pragma once\nint halved(int value);\nint doubled(int value);\nint tripled(int value);\n",
    "far/far.cpp": """#include "far/far.hpp"

int halved(int value) { return value / 2; }
int doubled(int value) { return value + value; }
int tripled(int value) { return value + 2 * value; }
""",
    "test/vantage.cpp": "#include \"far/far.hpp\"\nint main() { return doubled(2); }\n",
    "test/guard.sh": "$1/vantage\n[ $? = 4 ]\n",
    # Detects the mutation only if started by ctest; needs more time than known in advance.
    "test/far_test.cpp": """#include <cstdlib>
#include <ctime>

#include "far/far.hpp"
int main() {
  while (std::clock() < 2 * CLOCKS_PER_SEC) {
  }
  return std::getenv("ELSEWHERE") != nullptr && halved(8) == 4 ? 0 : 1;
}
""",
    # This test checks a clipped value but no unclipped one; a mutation at the limit cannot be detected.
    "test/toy_test.cpp": """#include "toy/toy.hpp"
int main() { return clipped(5, 3) == 3 && ends(4) ? 0 : 1; }
""",
    "test/slow_test.cpp": "#include \"toy/toy.hpp\"\nint main() { return clipped(1, 3) == 1 ? 0 : 1; }\n",
    "test/other_test.cpp": "int main() { return 0; }\n",
}


class Project(unittest.TestCase):
    """Whole runs on a small project. All share one build, which takes most of the time."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name) / "toy"
        for name, text in TOY.items():
            path = cls.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        cls.git("init", "--quiet")
        cls.git("config", "user.email", "toy@example.org")
        cls.git("config", "user.name", "Toy")
        cls.commit()
        cls.mutate("--draw", "toy=99", "--seed", "7")
        cls.drawn = cls.rows()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def git(cls, *words):
        return subprocess.run(["git", "-C", str(cls.root), *words], check=True, capture_output=True, text=True).stdout

    @classmethod
    def commit(cls):
        cls.git("add", "--all")
        cls.git("commit", "--quiet", "--message", "toy")

    @classmethod
    def mutate(cls, *words, code=0):
        done = subprocess.run([sys.executable, str(MUTATE), "--limit-slack", "1", *words], cwd=cls.root,
                              capture_output=True, text=True)
        assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}\n{done.stderr}"
        return done.stdout + done.stderr

    @classmethod
    def book(cls):
        return cls.root / "test/mutation/ledger.jsonl"

    @classmethod
    def rows(cls):
        return [json.loads(line) for line in cls.book().read_text().splitlines()]

    def setUp(self):
        self.book().write_text("".join(json.dumps(row) + "\n" for row in self.drawn))

    def id_of(self, operator, after):
        return next(r["id"] for r in self.rows() if r["operator"] == operator and r["after"] == after)

    def outcome(self, id_):
        row = next(r for r in self.rows() if r["id"] == id_)
        return row["outcome"], row.get("by", "")

    def assert_untouched(self):
        status = [line for line in self.git("status", "--porcelain").splitlines() if "test/mutation" not in line]
        self.assertEqual([], status)
        self.assertEqual(TOY["toy/toy.cpp"], (self.root / "toy/toy.cpp").read_text())

    def test_draw_is_reproducible(self):
        self.mutate("--draw", "toy=99", "--seed", "7")
        self.assertEqual(self.drawn, self.rows())
        self.mutate("--draw", "toy=99", "--seed", "7", "--ledger", "build/again.jsonl")
        self.assertEqual(self.book().read_text(), (self.root / "build/again.jsonl").read_text())

    def test_detected_undetected_and_endless_mutations(self):
        noticed = self.id_of("return", "if (value > most) { ; }")
        unnoticed = self.id_of("comparison", "value >= most")
        endless = self.id_of("reset", "")
        said = self.mutate("--run", noticed, unnoticed, endless)
        self.assertEqual(("killed", "toy.runs"), self.outcome(noticed))
        # Only a test labelled `long` could detect it, and the other program does not link the file.
        self.assertIn(self.outcome(unnoticed), [("survived", "toy_test"), ("same code", "")], said)
        self.assertRegex(" ".join(self.outcome(endless)), r"killed toy.runs \(.+\)", "out of CPU time")
        self.assertNotIn("other", said)
        self.assertNotIn("slow", said)
        self.assert_untouched()

    def test_untimed_tests_of_another_program_are_run(self):
        self.mutate("--draw", "far=99", "--seed", "7")
        noticed = self.id_of("constant", "value / 4")
        unnoticed = self.id_of("sign", "value - value")
        self.mutate("--run", noticed, unnoticed, "--scripts", "")
        self.assertEqual(("killed", "far.runs"), self.outcome(noticed))
        self.assertEqual(("survived", "far_test"), self.outcome(unnoticed), "it only took its time")

    def test_scripts_run_if_no_program_detects_a_mutation(self):
        self.mutate("--draw", "far=99", "--seed", "7")
        noticed = self.id_of("sign", "value - value")
        unnoticed = self.id_of("sign", "value - 2 * value")
        self.mutate("--run", noticed, unnoticed)
        self.assertEqual(("killed", "guard.table"), self.outcome(noticed))
        self.assertEqual(("survived", "far_test vantage"), self.outcome(unnoticed))

    def test_quick_runs_leave_slow_mutations_pending(self):
        noticed = self.id_of("return", "if (value > most) { ; }")
        unnoticed = self.id_of("comparison", "value >= most")
        self.mutate("--run", noticed, unnoticed, "--quick")
        self.assertEqual("killed", self.outcome(noticed)[0])
        self.assertIn(self.outcome(unnoticed)[0], ("pending", "same code"))

    def test_joint_and_single_runs_agree(self):
        self.mutate("--run", "--jobs", "2")
        alone = {r["id"]: r["outcome"] for r in self.rows() if r["file"].endswith(".cpp")}
        self.assertLessEqual({"killed", "survived", "not built"}, set(alone.values()))
        self.mutate("--sweep", "toy", "--jobs", "2")
        together = {r["id"]: r["outcome"]
                    for r in map(json.loads, (self.root / "build/mutate/sweep.jsonl").read_text().splitlines())}
        # Identical object code is detected only for mutations that are compiled separately.
        self.assertEqual({i: "survived" if o == "same code" else o for i, o in alone.items()}, together)
        self.assert_untouched()

    def test_resumes_and_repeats_survivors(self):
        first = self.rows()[0]["id"]
        self.mutate("--run", "--limit", "1")
        settled = [r for r in self.rows() if r["outcome"] != "pending"]
        self.assertEqual(1, len(settled))
        self.mutate("--run", "--limit", "1")
        self.assertEqual(2, len([r for r in self.rows() if r["outcome"] != "pending"]))
        self.assertTrue(any(r["id"] == first for r in self.rows()))

    def test_shows_and_applies_mutations_by_id(self):
        id_ = self.id_of("comparison", "value < most")
        self.assertIn("-  if (value > most) {\n+  if (value < most) {", self.mutate("--show", id_))
        self.assert_untouched()
        self.mutate("--apply", id_)
        self.assertIn("value < most", (self.root / "toy/toy.cpp").read_text())
        self.assertIn("commit or stash first: toy/toy.cpp", self.mutate("--run", id_, code=2))
        self.git("checkout", "--", "toy/toy.cpp")

    def test_equivalent_requires_a_reason(self):
        id_ = self.id_of("comparison", "value >= most")
        self.mutate("--equivalent", id_, "so", code=2)
        self.mutate("--equivalent", id_, "both sides of the edge give the same value")
        self.assertEqual("equivalent", self.outcome(id_)[0])
        self.assertIn("| toy |", self.mutate("--table"))

    def test_only_changed_lines_are_mutated(self):
        path = self.root / "toy/toy.cpp"
        path.write_text(TOY["toy/toy.cpp"].replace("left == 0;", "0 == left;"))
        self.commit()
        try:
            self.mutate("--change", "HEAD~1")
            rows = [json.loads(line) for line in (self.root / "build/mutate/change.jsonl").read_text().splitlines()]
            self.assertEqual({"0 == left"}, {r["before"] for r in rows})
            self.assertNotIn("pending", {r["outcome"] for r in rows})
        finally:
            path.write_text(TOY["toy/toy.cpp"])
            self.commit()

    def stopped_by(self, number):
        """Runs a mutation that never ends, and stops the run by a signal while the mutation is in place."""
        endless = self.id_of("reset", "")
        program = self.root / "build/mutate/work" / endless / "toy_test"
        # A test that runs in the background ignores Ctrl-C, so the default action is restored.
        run = subprocess.Popen([sys.executable, str(MUTATE), "--run", endless], cwd=self.root,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        while not program.exists():
            self.assertIsNone(run.poll())
            time.sleep(0.01)
        run.send_signal(number)
        run.communicate()
        self.assert_untouched()
        self.assertEqual("pending", self.outcome(endless)[0])
        return program, run.returncode

    def test_stopped_run_restores_the_checkout(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            program, returned = self.stopped_by(number)
            self.assertEqual(code, returned)
            self.assertFalse(program.exists())

    def test_killed_run_leaves_the_checkout_usable(self):
        program, _ = self.stopped_by(signal.SIGKILL)
        self.mutate("--show", self.rows()[0]["id"])
        self.assertFalse(program.exists())


if __name__ == "__main__":
    if not sites.is_available():
        print("skipped: no libclang for Python (tools/setup --mutate)")
        sys.exit(77)
    unittest.main(verbosity=2)
