#!/usr/bin/env python3
"""A sweep's columns equal the results of its trials for any number of threads, and survive an early end."""
import signal
import unittest

import numpy
import vantage

LAB = vantage.Scenario("lab").replace(duration_s=3.0)
PARAMETERS = {"node_budget": [50, 200], "planner": ["greedy", "arvi"]}
SEEDS = (4, 2)


def row(columns, i):
    return {name: column[i].tobytes() for name, column in columns.items()}


class Sweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.columns = vantage.sweep(LAB, PARAMETERS, SEEDS, threads=2)

    def test_has_every_combination_in_order(self):
        self.assertEqual(self.columns["node_budget"].tolist(), 4 * [50] + 4 * [200])
        self.assertEqual(self.columns["planner"].tolist(), 2 * (2 * ["greedy"] + 2 * ["arvi"]))
        self.assertEqual(self.columns["seed"].tolist(), 4 * [4, 2])

    def test_results_equal_single_trials(self):
        for i in (0, 3, 6):
            trial = vantage.Trial(LAB.replace(node_budget=int(self.columns["node_budget"][i]),
                                              planner=str(self.columns["planner"][i]), seed=SEEDS[i % 2]))
            trial.run()
            for name in ("entropy", "collisions", "plans", "duration_s"):
                self.assertEqual(self.columns[name][i], trial.metrics[name])
            self.assertEqual(self.columns["per_robot.entropy"][i], trial.metrics["per_robot"]["entropy"])
        self.assertGreater(len(set(self.columns["entropy"])), 2)
        self.assertTrue(numpy.isnan(self.columns["map_entropy"]).all())  # no robot maps
        self.assertNotIn("discovery_time_s", self.columns)  # a list

    def test_accepts_the_path_of_any_scenario_key(self):
        columns = vantage.sweep(LAB, {"planner.separation_m": [0.6, 0.7],
                                      "robot_defaults.sensor.range_sigma_m": numpy.array([0.1])}, [1], threads=2)
        self.assertEqual(columns["planner.separation_m"].tolist(), [0.6, 0.7])
        text = LAB.replace(keys={"planner.separation_m": "0.7", "network.url": '"memq://"'}).text
        self.assertIn("separation_m: 0.7", text)
        for refused in ({"planner.separation_m": [-1]}, {"planner.no_such_key": [1]}):
            with self.assertRaisesRegex(vantage.StartupError, next(iter(refused)).split(".")[1]):
                vantage.sweep(LAB, refused, [1])

    def test_is_independent_of_the_number_of_threads(self):
        for threads in (1, 5):
            columns = vantage.sweep(LAB, PARAMETERS, SEEDS, threads=threads)
            self.assertEqual(list(columns), list(self.columns))
            for name, column in columns.items():
                self.assertEqual(column.dtype, self.columns[name].dtype)
                self.assertEqual(column.tobytes(), self.columns[name].tobytes(), name)

    def test_reports_its_progress(self):
        shares = []
        vantage.sweep("lab", {"duration_s": [1.0], "node_budget": [50]}, range(3), threads=2, progress=shares.append)
        self.assertEqual(shares, [1 / 3, 2 / 3, 1.0])

    def test_keeps_finished_trials_at_ctrl_c(self):
        def interrupt(share):
            signal.raise_signal(signal.SIGINT)
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with self.assertRaises(KeyboardInterrupt) as stopped:
                vantage.sweep(LAB, PARAMETERS, SEEDS, threads=1, progress=interrupt)
        finally:
            signal.signal(signal.SIGINT, before)
        columns = stopped.exception.columns
        self.assertEqual(list(columns), list(self.columns))
        self.assertGreaterEqual(len(columns["seed"]), 1)
        for i in range(len(columns["seed"])):
            self.assertEqual(row({**columns, "planner": columns["planner"].astype("U6")}, i), row(self.columns, i))

    def test_invalid_options_are_refused_before_the_first_trial(self):
        for words, parameters, seeds, options in (
                ("unknown key horizon; valid keys are duration_s, planner", {"horizon": [1]}, [1], {}),
                ("planner: must be a list of values, got arvi", {"planner": "arvi"}, [1], {}),
                ("seeds: must be a list of whole numbers, got 3", {}, 3, {}),
                ("each must have at least one value", {"planner": []}, [1], {}),
                ("threads: must be ≥ 1, got 0", {}, [1], {"threads": 0})):
            with self.assertRaisesRegex(vantage.UsageError, words):
                vantage.sweep(LAB, parameters, seeds, **options)
        flown = []
        with self.assertRaisesRegex(vantage.StartupError, "duration_s"):
            vantage.sweep(LAB, {"duration_s": [0.5, -1.0]}, [1], progress=flown.append)
        self.assertEqual(flown, [])


if __name__ == "__main__":
    unittest.main()
