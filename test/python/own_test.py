#!/usr/bin/env python3
"""Planners, costs, filters and target models that a user writes in Python fly in a trial."""
import os
import pathlib
import tempfile
import unittest

import numpy
import vantage
from here import SOURCE, command
from vantage import own

LAB = SOURCE / "config/lab.yaml"
ROBOTS = ("Q1", "Q2", "Q3")


def lab(**changes):
    text = LAB.read_text().replace("kind: damped_oscillator ", "kind: double_integrator ")
    return vantage.Scenario.parse(text).replace(**{"seed": 3, "duration_s": 6.0, "node_budget": 300, **changes})


class Frozen:
    """A target model that is not in the library: speed decays with a time constant of 1 s."""

    def __init__(self):
        self.used = 0

    def transition(self, dt_s):
        self.used += 1
        decay = numpy.exp(-dt_s)
        A = numpy.eye(4)
        A[:2, 2:] = numpy.eye(2) * (1 - decay)
        A[2:, 2:] = numpy.eye(2) * decay
        return A

    def process_noise(self, dt_s):
        return numpy.diag([0.02, 0.02, 0.1, 0.1]) * dt_s


class Turning(Frozen):
    """A nonlinear target model, defined by its prediction and its Jacobian."""

    def transition(self, dt_s, mean):
        return Frozen.transition(self, dt_s)

    def expected(self, mean, dt_s):
        return Frozen.transition(self, dt_s) @ mean


class Planners(unittest.TestCase):
    def test_custom_planners_fly_in_a_trial(self):
        asked = []

        def ahead(question):
            asked.append(question)
            return [(0.5, 0.2, 1.0), (0.25, -0.2, 0.5)]

        trial = vantage.Trial(lab(), planners={robot: ahead for robot in ROBOTS})
        sources = set()
        while not trial.is_over:
            trial.step(1)
            sources |= {(robot, plan["source"]) for robot, plan in trial.plans.items()}
        self.assertEqual(trial.scenario.text.count("algorithm: external"), 1)
        self.assertEqual({question["robot"] for question in asked}, set(ROBOTS))
        last = asked[-1]
        self.assertEqual(last["controls"].shape[1], 2)
        self.assertEqual({poses.shape for poses in last["team"].values()}, {(13, 3)})
        self.assertEqual(set(last["team"]), set(ROBOTS) - {last["robot"]})
        for mean, covariance in last["beliefs"].values():
            self.assertEqual((len(mean),), covariance.shape[:1])
        self.assertLessEqual({(robot, "searched") for robot in ROBOTS}, sources)  # others may occur later
        self.assertEqual(trial.metrics["collisions"], 0)

    def test_missing_or_invalid_plans_are_not_flown(self):
        for answer in (None, [(100.0, 0.0, 1.0)], [(1.0, 0.0, -1.0)], [(0.5, 0.0, 1000.0)]):
            trial = vantage.Trial(lab(duration_s=3.0), planners={robot: lambda question: answer for robot in ROBOTS})
            trial.run()
            self.assertEqual({plan["source"] for plan in trial.plans.values()}, {"shifted"}, answer)

    def test_are_reproducible_and_replayable(self):
        def turn(question):
            return [(0.4, 0.3 * numpy.sin(question["time_s"]), 1.0)]

        with tempfile.TemporaryDirectory() as folder:
            logs = [os.path.join(folder, name) for name in ("one", "two")]
            for path in logs:
                trial = vantage.Trial(lab(), planners={robot: turn for robot in ROBOTS}, log=path)
                trial.run()
                del trial  # ends the log
            one, two = (pathlib.Path(path).read_bytes() for path in logs)
            self.assertTrue(one == two)
            command("log", "replay", logs[0], "--node", "planner:Q2")

    def test_refusals_name_the_argument(self):
        with self.assertRaisesRegex(vantage.UsageError, "has none for Q2"):
            vantage.Trial(lab(), planners={"Q1": lambda question: None})
        with self.assertRaisesRegex(vantage.UsageError, "no robot Q9"):
            vantage.Trial(lab(), planners={robot: lambda question: None for robot in (*ROBOTS, "Q9")})
        with self.assertRaisesRegex(vantage.UsageError, "planners"):
            vantage.Trial(lab(planner="external"))
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            vantage.Trial(lab(), planners={robot: lambda question: 1 / 0 for robot in ROBOTS}).run()


class Searches(unittest.TestCase):
    def search(self, robot="Q1", **how):
        return own.Search(lab(), robot, **{"width": 2, **how})

    def test_use_a_custom_cost_and_target_model(self):
        model = Frozen()
        costs = []

        def cost(pose, beliefs, step):
            costs.append(step)
            return own.uncertainty(pose, beliefs, step) + 0.1 * abs(pose[1])

        scenario = lab(duration_s=4.0)
        trial = vantage.Trial(scenario, planners={
            robot: own.Search(scenario, robot, model=model, cost=cost, width=1) for robot in ROBOTS})
        trial.run()
        self.assertGreater(model.used, 0)
        self.assertEqual(set(costs), set(range(1, 13)))
        self.assertIn("searched", {plan["source"] for plan in trial.plans.values()})
        self.assertEqual(trial.metrics["collisions"], 0)

    def question(self):
        return {"robot": "Q1", "round": 0, "time_s": 0.0, "pose": numpy.array([-3.0, 0.0, 0.0]), "speed_mps": 0.0,
                "height_m": 1.0, "horizon_steps": 4, "step_s": 0.5, "controls": vantage.lab_primitives(),
                "beliefs": {0: (numpy.array([-1.0, -1.0, 0.0, 0.0]), numpy.diag([1.0, 1.0, 0.1, 0.1]))}, "team": {}}

    def test_minimise_the_custom_cost(self):
        for sign in (1.0, -1.0):
            rows = self.search(cost=lambda pose, beliefs, step: sign * pose[1], width=8)(self.question())
            pose = self.question()["pose"]
            for speed, yaw_rate, duration_s in rows:
                pose = vantage.step_unicycle(pose, (speed, yaw_rate), duration_s)
            self.assertLess(sign * pose[1], -0.5)

    def test_return_no_plan_without_a_feasible_path(self):
        question = self.question()
        question["pose"] = numpy.array([-3.9, -1.9, 0.0])
        self.assertIsNone(self.search()(question))
        question = self.question()
        question["team"] = {"Q2": numpy.tile(question["pose"], (5, 1))}
        self.assertIsNone(self.search()(question))


class Filters(unittest.TestCase):
    def test_with_the_default_model_find_the_targets(self):
        scenario = lab(duration_s=8.0)
        trial = vantage.Trial(scenario, filters={"Q1": own.Filter(scenario, "Q1")})
        trial.run()
        self.assertEqual(trial.metrics["collisions"], 0)
        plain = vantage.Trial(scenario)
        plain.run()
        mine, theirs = trial.beliefs["Q1"], plain.beliefs["Q1"]
        self.assertTrue(set(theirs["ids"]) & set(mine["ids"]))
        for i, mean in zip(mine["ids"], mine["means"]):
            self.assertLess(numpy.hypot(*(mean[:2] - trial.targets[i, :2])), 4.0)

    def test_use_a_custom_target_model(self):
        for model in (Frozen(), Turning()):
            scenario = lab()
            trial = vantage.Trial(scenario, filters={robot: own.Filter(scenario, robot, model) for robot in ROBOTS})
            trial.run()
            self.assertGreater(model.used, 0)
            known = {i for belief in trial.beliefs.values() for i in belief["ids"].tolist()}
            self.assertTrue(known)

    def test_refusals_name_argument_and_shape(self):
        with self.assertRaisesRegex(vantage.UsageError, "no robot Q9"):
            vantage.Trial(lab(), filters={"Q9": lambda looks, time_s: {}})
        with self.assertRaisesRegex(ValueError, "mean: must have the shape"):
            vantage.Trial(lab(), filters={"Q1": lambda looks, time_s: {0: ([1.0], [[1.0]])}}).run()
        with self.assertRaisesRegex(vantage.UsageError, "covariance: must be positive definite"):
            vantage.Trial(lab(), filters={"Q1": lambda looks, time_s: {0: ([0] * 4, numpy.zeros((4, 4)))}}).run()


if __name__ == "__main__":
    unittest.main()
