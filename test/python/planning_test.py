#!/usr/bin/env python3
"""Plans in Python equal those of `vantage plan` bit for bit, and error texts are equal."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy
import vantage
from here import PROBLEMS, command, command_json

FILES = ["tracking.json", "mapping.json"]


def loaded(file="tracking.json"):
    return json.loads((PROBLEMS / file).read_text())


class Plan(unittest.TestCase):
    def test_equals_the_plan_of_the_command_bit_for_bit(self):
        for file in FILES:
            for algorithm in ["default", *vantage.algorithms()]:
                with self.subTest(file=file, algorithm=algorithm):
                    plan = vantage.plan(PROBLEMS / file, algorithm=algorithm, nodes=5000)
                    printed = command_json("plan", PROBLEMS / file, "--algorithm", algorithm, "--nodes", 5000,
                                           code=0 if plan.found else 1)
                    self.assertEqual(printed["algorithm"], plan.algorithm)
                    self.assertEqual(printed["cost"], plan.cost)  # both are the shortest text
                    self.assertEqual(printed["lower_bound"], plan.lower_bound)
                    self.assertEqual(printed["gap"], plan.gap)
                    self.assertEqual(printed["epsilon"], plan.epsilon)
                    self.assertEqual(printed["delta"], plan.delta_m)
                    self.assertEqual(printed["controls"], plan.controls.tolist())
                    self.assertEqual(printed["states"], plan.states.tolist())
                    for key in ("nodes_generated", "nodes_expanded", "work_nodes", "passes", "stop_reason"):
                        self.assertEqual(printed[key], getattr(plan, key), key)

    def test_is_equal_for_file_text_and_dict(self):
        text = (PROBLEMS / "tracking.json").read_text()
        planner = vantage.Planner("arvi", nodes=3000)
        of_file = planner.plan(vantage.Problem(PROBLEMS / "tracking.json"))
        of_dict = planner.plan(vantage.Problem(json.loads(text)))
        of_text = planner.plan(vantage.Problem.parse(text))
        self.assertTrue(of_file.found)
        for other in (of_dict, of_text):
            self.assertEqual(of_file.states.tobytes(), other.states.tobytes())
            self.assertEqual(of_file.cost, other.cost)

    def test_accepts_numpy_in_a_dict(self):
        problem = loaded()
        problem["targets"] = numpy.array(problem["targets"])
        problem["T"] = numpy.int64(problem["T"])
        self.assertEqual(vantage.plan(problem, nodes=500).cost, vantage.plan(loaded(), nodes=500).cost)

    def test_cost_equals_the_plain_recursion(self):
        for file in FILES:
            problem = vantage.Problem(PROBLEMS / file)
            plan = vantage.plan(problem, algorithm="beam", nodes=20_000)
            self.assertTrue(plan.found)
            self.assertAlmostEqual(plan.cost, problem.score(plan.states), delta=1e-6 * abs(plan.cost))
            self.assertLessEqual(plan.lower_bound, plan.cost)
            self.assertAlmostEqual(plan.gap, plan.cost - plan.lower_bound)

    def test_follows_its_controls(self):
        problem = vantage.Problem(PROBLEMS / "tracking.json")
        plan = vantage.plan(problem, nodes=2000)
        pose = problem.start
        for control, state in zip(problem.controls[plan.controls], plan.states):
            pose = vantage.step_unicycle(pose, control, problem.step_s)
            numpy.testing.assert_allclose(pose, state, atol=1e-9)

    def test_changed_problem_gives_the_plan_of_a_new_problem(self):
        changed = loaded()
        changed["robot"]["yaw"] = 1.25
        changed["targets"] = changed["targets"][:3]
        changed["targets"][0][0] += 0.5
        changed.pop("n_targets", None)
        problem = vantage.Problem(loaded())
        planner = vantage.Planner("beam", nodes=4000)
        planner.plan(problem)
        problem.start = (*problem.start[:2], 1.25)
        problem.set_beliefs(changed["targets"], numpy.tile(numpy.diag(changed["prior_cov_diag"]), (3, 1, 1)))
        self.assertEqual(problem.means.tolist(), changed["targets"])
        again = planner.plan(problem)
        new = vantage.Planner("beam", nodes=4000).plan(vantage.Problem(changed))
        self.assertEqual(again.cost, new.cost)
        self.assertEqual(again.controls.tolist(), new.controls.tolist())

    def test_lets_other_threads_run(self):
        problem = vantage.Problem(PROBLEMS / "tracking.json")
        planner = vantage.Planner("arvi", nodes=3_000_000)
        planner.prepare(problem)
        thread = threading.Thread(target=planner.plan, args=(problem,))
        thread.start()
        counted = 0
        while thread.is_alive():
            counted += 1
        self.assertGreater(counted, 1000)

    def test_two_threads_may_share_planner_and_problem(self):
        problem = vantage.Problem(PROBLEMS / "tracking.json")
        planner = vantage.Planner("beam", nodes=20_000)
        costs = []
        threads = [threading.Thread(target=lambda: costs.append(planner.plan(problem).cost)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(costs, 4 * [vantage.plan(problem, algorithm="beam", nodes=20_000).cost])

    def test_budget_of_zero_still_gives_a_plan(self):
        plan = vantage.plan(PROBLEMS / "tracking.json", budget_s=0.01)
        self.assertTrue(plan.found)
        self.assertEqual(plan.history.shape[1], 4)


# A thread prints "plans" as soon as the plan releases the interpreter's lock.
PLANS_FOR_AN_HOUR = """
import signal, sys, threading
import vantage
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.setswitchinterval(1000)
problem, planner, gate = vantage.Problem(sys.argv[1]), vantage.Planner("beam", budget_s=3600), threading.Lock()
planner.prepare(problem)
def say():
    with gate:
        print("plans", flush=True)
with gate:
    threading.Thread(target=say).start()
try:
    planner.plan(problem)
    print("has planned")
except KeyboardInterrupt:
    print("interrupted")
"""

# A signal handler that uses the planner that it has interrupted gets an error instead of a deadlock.
ASKS_IN_A_HANDLER = PLANS_FOR_AN_HOUR.replace("signal.default_int_handler", "lambda *_: planner.prepare(problem)") \
    .replace("except KeyboardInterrupt", "except vantage.UsageError")


class CtrlC(unittest.TestCase):
    def ends(self, program):
        child = subprocess.Popen([sys.executable, "-c", program, PROBLEMS / "tracking.json"], stdout=subprocess.PIPE,
                                 text=True)
        with child:
            self.assertEqual(child.stdout.readline(), "plans\n")
            child.send_signal(signal.SIGINT)
            self.assertEqual(child.stdout.read().split(), ["interrupted"])
        self.assertEqual(child.returncode, 0)

    def test_ends_a_long_plan(self):
        self.ends(PLANS_FOR_AN_HOUR)

    def test_handler_that_uses_the_busy_planner_gets_an_error(self):
        self.ends(ASKS_IN_A_HANDLER)


class Refusal(unittest.TestCase):
    def test_text_equals_that_of_the_command(self):
        broken = []
        for change in ({"T": 0}, {"tau": "half"}, {"sensor": {"type": "sonar"}}, {"horizont": 3},
                       {"robot": {"x": 1e9, "y": 0}}):
            problem = loaded()
            problem.update(change)
            broken.append(json.dumps(problem))
        broken += ["{", "[1, 2]", '{"T": 1, "T": 2}']
        with tempfile.TemporaryDirectory() as folder:
            for text in broken:
                path = os.path.join(folder, "problem.json")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
                _, error_text = command("plan", path, code=2)
                with self.assertRaises(vantage.StartupError) as of_file:
                    vantage.Problem(path)
                self.assertIn(str(of_file.exception), error_text)
                with self.assertRaises(vantage.StartupError) as of_text:
                    vantage.Problem.parse(text, path)
                self.assertEqual(str(of_text.exception), str(of_file.exception))

    def test_names_the_missing_file(self):
        with self.assertRaisesRegex(vantage.StartupError, "nowhere.json: no such file"):
            vantage.Problem("nowhere.json")

    def test_names_the_argument(self):
        with self.assertRaisesRegex(vantage.UsageError, "algorithm: must be one of default, beam.*got best"):
            vantage.Planner("best")
        with self.assertRaisesRegex(vantage.UsageError, "nodes: must be ≥ 1"):
            vantage.Planner(nodes=0)
        with self.assertRaisesRegex(vantage.UsageError, "only one of them"):
            vantage.Planner(nodes=1, budget_s=1.0)
        with self.assertRaisesRegex(vantage.UsageError, "weight: must be ≥ 1"):
            vantage.Planner(weight=float("nan"))
        self.assertTrue(issubclass(vantage.UsageError, ValueError))

    def test_problem_remains_unchanged(self):
        problem = vantage.Problem(loaded())
        start, covariances = problem.start, problem.covariances
        with self.assertRaises(vantage.UsageError):
            problem.set_beliefs(problem.means, -covariances)
        with self.assertRaises(vantage.UsageError):
            problem.start = (1e6, 0.0, 0.0)
        with self.assertRaisesRegex(ValueError, "means: must have the shape"):
            problem.set_beliefs(problem.means[:, :1], covariances)
        with self.assertRaises(vantage.UsageError):
            problem.start = (float("nan"), 0.0, 0.0)
        self.assertEqual(problem.start.tolist(), start.tolist())
        self.assertEqual(problem.covariances.tolist(), covariances.tolist())


class Help(unittest.TestCase):
    def test_names_the_searches(self):
        import io
        from contextlib import redirect_stdout
        from vantage.__main__ import main
        out = io.StringIO()
        with redirect_stdout(out):
            self.assertEqual(main([]), 0)
        for name in vantage.algorithms():
            self.assertIn(name, out.getvalue())

    def test_everything_has_a_docstring(self):
        for name in vantage.__all__:
            self.assertTrue(getattr(vantage, name).__doc__, name)


if __name__ == "__main__":
    unittest.main()
