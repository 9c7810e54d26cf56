#!/usr/bin/env python3
"""A trial stepped from Python equals `vantage trial` byte for byte, and its state can be read."""
import os
import pathlib
import tempfile
import unittest

import numpy
import vantage
from here import SOURCE, command, command_json

LAB = SOURCE / "config/lab.yaml"
SMALL = {
    "name": "small", "duration_s": 2, "world": {"bounds": {"min_m": [-4, -4], "max_m": [4, 4]}},
    "robot_defaults": {"primitives": "lab", "limits": {"speed_max_mps": 1},
                       "sensor": {"kind": "range_bearing", "range_max_m": 2, "range_min_m": 0.1}},
    "robots": [{"name": "Q1", "start": {"x_m": 0, "y_m": 0, "yaw_deg": 0}, "height_m": 1.0}],
    "targets": {"count": numpy.int64(1)},
    "planner": {"node_budget": 100}}


def short(**changes):
    return vantage.Scenario(LAB).replace(**{"seed": 3, "duration_s": 6.0, "node_budget": 300, **changes})


class Scenario(unittest.TestCase):
    def test_equals_the_file(self):
        lab = vantage.Scenario(LAB)
        self.assertEqual(lab.name, "lab")
        self.assertEqual(lab.robots, ["Q1", "Q2", "Q3"])
        self.assertEqual(lab.targets, ["R1", "R2", "R3", "R4", "R5"])
        self.assertEqual(lab.bounds.tolist(), [-4, -2, 4, 2])
        self.assertEqual(lab.obstacles.shape, (2, 4))
        self.assertEqual(lab.step_s, 0.5)
        self.assertEqual(lab.text, LAB.read_text())

    def test_accepts_a_dict(self):
        trial = vantage.Trial(SMALL)
        trial.run()
        self.assertEqual(trial.robots.shape, (1, 7))

    def test_refusal_equals_that_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            for change in (("duration_s: 300", "duration_s: -1"), ("seed: 1", "sed: 1"),
                           ("height_m: 1.5", "height_m: high")):
                path = os.path.join(folder, "lab.yaml")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(LAB.read_text().replace(*change))
                _, error_text = command("trial", path, code=2)
                with self.assertRaises(vantage.StartupError) as refusal:
                    vantage.Scenario(path)
                self.assertIn(str(refusal.exception), error_text)
                self.assertRegex(str(refusal.exception), r"lab\.yaml:\d+: ")

    def test_refusal_of_a_dict_states_the_line(self):
        with self.assertRaisesRegex(vantage.StartupError, r"scenario:3: duration_s: "):
            vantage.Scenario({**SMALL, "duration_s": -1})
        with self.assertRaisesRegex(TypeError, "must be a number, text, list or dict"):
            vantage.Scenario({**SMALL, "seed": object()})


class Trial(unittest.TestCase):
    def test_equals_the_command_for_any_steps(self):
        with tempfile.TemporaryDirectory() as folder:
            logs = {way: os.path.join(folder, way) for way in ("command", "whole", "steps", "pieces")}
            printed = command_json("trial", LAB, "--seed", 3, "--duration-s", 6, "--log", logs["command"])
            scenario = vantage.Scenario(LAB).replace(seed=3, duration_s=6.0)
            whole = vantage.Trial(scenario, log=logs["whole"])
            whole.run()
            steps = vantage.Trial(scenario, log=logs["steps"])
            while not steps.is_over:
                steps.step()
                steps.metrics, steps.beliefs  # reading changes nothing
            pieces = vantage.Trial(scenario, log=logs["pieces"])
            for piece_s in [0.001, 0.3333, 0.0, 1.7, 2.2, 0.6, 60.0]:
                pieces.advance(piece_s)
            for trial in (whole, steps, pieces):
                self.assertTrue(trial.is_over)
                self.assertEqual(trial.time_s, 6.0)
                self.assertEqual(trial.metrics, printed)
            del whole, steps, pieces, trial  # ends the logs
            reference = pathlib.Path(logs["command"]).read_bytes()
            self.assertGreater(len(reference), 100_000)
            for way in ("whole", "steps", "pieces"):
                self.assertTrue(pathlib.Path(logs[way]).read_bytes() == reference, way)

    def test_shows_robots_targets_beliefs_and_plans(self):
        trial = vantage.Trial(short())
        self.assertTrue(numpy.isnan(trial.robots).all())
        trial.step(8)
        self.assertEqual(trial.time_s, 4.0)
        self.assertEqual(trial.robots.shape, (3, 7))
        self.assertEqual(trial.targets.shape, (5, 7))
        bounds = trial.scenario.bounds
        for bodies in (trial.robots, trial.targets):
            self.assertTrue((bodies[:, :2] >= bounds[:2]).all() and (bodies[:, :2] <= bounds[2:]).all())
        numpy.testing.assert_allclose(trial.robots[:, 2], [1.0, 1.5, 2.0], atol=0.1)
        self.assertEqual(set(trial.beliefs), {"Q1", "Q2", "Q3"})
        known = 0
        for belief in trial.beliefs.values():
            count = len(belief["ids"])
            known += count
            self.assertEqual(belief["means"].shape[0], count)
            self.assertLessEqual(belief["time_s"], 4.0)
            self.assertEqual(belief["grid_last_seen_utime"].shape, (16, 32))
            for identity, mean, covariance in zip(belief["ids"], belief["means"], belief["covariances"]):
                numpy.testing.assert_allclose(covariance, covariance.T, atol=1e-12)
                self.assertGreater(numpy.linalg.eigvalsh(covariance)[0], 0)
                error = mean[:2] - trial.targets[identity, :2]
                self.assertLess(numpy.hypot(*error), 4.0)
        self.assertGreater(known, 0)
        for plan in trial.plans.values():
            self.assertEqual(plan["poses"].shape, (13, 3))
            self.assertIn(plan["source"], ("searched", "shifted", "braking"))

    def test_shows_the_map_of_a_mapping_team(self):
        trial = vantage.Trial(vantage.Scenario(SOURCE / "config/mapping.yaml").replace(
            duration_s=4.0, node_budget=300))
        trial.run()
        for each in trial.maps.values():
            self.assertEqual(each["looks"].shape, (60, 60))
            self.assertGreater(numpy.count_nonzero(each["looks"]), 10)

    def test_uses_the_node_budget_of_the_command(self):
        self.assertIn("node_budget: 20000", vantage.Trial(LAB).scenario.text)

    def test_stops_if_the_progress_callback_raises(self):
        def stop(share):
            raise KeyboardInterrupt
        trial = vantage.Trial(short())
        with self.assertRaises(KeyboardInterrupt):
            trial.run(stop)
        self.assertEqual(trial.time_s, 0.5)
        trial.run()
        self.assertTrue(trial.is_over)


class OwnSensor(unittest.TestCase):
    def test_without_detections_gives_no_measurements(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "log")
            trial = vantage.Trial(short(), log=path, sensors={"Q1": lambda viewpoint, targets, time_s: []})
            trial.run()
            del trial
            log = vantage.Log(path)
            self.assertEqual(len(log["MEASUREMENT_Q1"]["detections.target_id"]), 0)
            self.assertGreater(len(log["MEASUREMENT_Q1"].log_utime), 8)
            self.assertGreater(len(log["MEASUREMENT_Q2"].log_utime), 8)

    def test_with_all_detections_finds_every_target(self):
        sensor = vantage.SensorModel("range_bearing")
        seen = []

        def look(viewpoint, targets, time_s):
            seen.append((viewpoint.shape, sorted(targets), time_s))
            return [(identity, sensor.observe(viewpoint, place[:2]), numpy.diag([0.01**2, 0.01**2]))
                    for identity, place in targets.items()]
        trial = vantage.Trial(short(), sensors={name: look for name in ("Q1", "Q2", "Q3")})
        trial.run()
        self.assertGreater(len(seen), 30)
        self.assertEqual(seen[0][:2], ((4,), [0, 1, 2, 3, 4]))
        self.assertEqual(trial.metrics["discovered"], 5)
        plain = vantage.Trial(short())
        plain.run()
        self.assertLess(trial.metrics["rmse_m"], 0.5 * plain.metrics["rmse_m"])

    def test_error_ends_the_step(self):
        def look(viewpoint, targets, time_s):
            raise ZeroDivisionError("a sensor of one's own")
        trial = vantage.Trial(short(), sensors={"Q2": look})
        with self.assertRaisesRegex(ZeroDivisionError, "of one's own"):
            trial.run()

    def test_measurement_of_wrong_shape_is_refused(self):
        trial = vantage.Trial(short(), sensors={"Q2": lambda *_: [(0, [1.0], [[1.0]])]})
        with self.assertRaisesRegex(ValueError, "z: must have the shape"):
            trial.run()

    def test_unknown_robot_is_refused(self):
        with self.assertRaisesRegex(vantage.UsageError, "no robot Q9"):
            vantage.Trial(short(), sensors={"Q9": lambda *_: []})

    def test_may_not_step_its_trial(self):
        trials = []
        trial = vantage.Trial(short(), sensors={"Q1": lambda *_: trials[0].step() or []})
        trials.append(trial)
        with self.assertRaisesRegex(vantage.UsageError, "is already being stepped"):
            trial.run()
        trials.clear()


if __name__ == "__main__":
    unittest.main()
