#!/usr/bin/env python3
"""Compares a team's decision with the plain recursion in numpy and with every possible choice."""
import itertools
import json
import unittest

import numpy
import vantage
from here import PROBLEMS

STARTS = ((0.0, -0.5, 0.4), (1.0, -2.0, 0.6), (-4.0, 4.0, 1.6))
STEPS = 4
FEW = {"candidates_max": 6, "nodes": 5000, "epsilon": 0.0, "delta_m": 0.0}  # the six best candidates
CHOOSING = ("coordinate_descent", "greedy", "local_search", "distributed_local_search", "exhaustive")


def spec(start):
    problem = json.loads((PROBLEMS / "tracking.json").read_text())
    problem.update(robot=dict(zip(("x", "y", "yaw"), start)), T=STEPS,
                   controls=[problem["controls"][i] for i in (0, 1, 2, 5, 8)])
    return problem


def team():
    return [vantage.Problem(spec(start)) for start in STARTS]


class Reference:
    """Computes J of a choice among a decision's candidates, using only the library's sensor model."""

    def __init__(self, decision, measure="mutual"):
        given = spec(STARTS[0])
        self.measure, self.counts = measure, [len(own) for own in decision.candidates]
        model = vantage.TargetModel("double_integrator", q=given["q"])
        self.A, self.W = model.transition(given["tau"]), model.process_noise(given["tau"])
        self.prior, self.T, self.tau = numpy.diag(given["prior_cov_diag"]), given["T"], given["tau"]
        self.controls = numpy.array(given["controls"])
        about = given["sensor"]
        self.sensor = vantage.SensorModel(
            "range_bearing", range_max_m=about["range"], range_min_m=1e-3, fov_rad=numpy.radians(about["fov_deg"]),
            range_sigma_m=about["sigma_r"], bearing_sigma_rad=numpy.radians(about["sigma_b_deg"]))
        low, high = given["map"]["min"], given["map"]["max"]
        self.world = vantage.World([*low, *high], given["map"]["obstacles"])
        self.means = [numpy.array(given["targets"])]
        for _ in range(self.T):
            self.means.append(self.means[-1] @ self.A.T)
        self.looks = [[self._looks(start, row) for row in own] for start, own in zip(STARTS, decision.candidates)]
        self.known = {}

    def _looks(self, start, row):
        """Returns (T, M, 2, 2): the information of a candidate's measurements of each target after each step."""
        pose, out = numpy.array(start), []
        for step, control in enumerate(self.controls[row], 1):
            pose = vantage.step_unicycle(pose, control, self.tau)
            viewpoint = (pose[0], pose[1], 0.0, pose[2])
            out.append([self.sensor.information(viewpoint, mean[:2]) * self.world.line_of_sight(pose[:2], mean[:2])
                        for mean in self.means[step]])
        return numpy.array(out)

    def value(self, choice):
        """Returns ½ Σ (log det reference − log det updated). The reference covariance is predicted just before the
        update (measure "mutual"), or otherwise without any measurement."""
        if choice not in self.known:
            looks = sum((self.looks[robot][row] for robot, row in enumerate(choice) if row is not None),
                        numpy.zeros((self.T, len(self.means[0]), 2, 2)))
            after = unseen = numpy.tile(self.prior, (len(self.means[0]), 1, 1))
            nats = 0.0
            for M in looks:
                before, unseen = (self.A @ covariance @ self.A.T + self.W for covariance in (after, unseen))
                information = numpy.linalg.inv(before)
                information[:, :2, :2] += M
                after = numpy.linalg.inv(information)
                reference = before if self.measure == "mutual" else unseen
                nats += 0.5 * (numpy.linalg.slogdet(reference)[1] - numpy.linalg.slogdet(after)[1]).sum()
            self.known[choice] = nats
        return self.known[choice]

    def choices(self, may_rest=True, robots=range(len(STARTS))):
        """Returns every choice of `robots`; all other robots do nothing."""
        return itertools.product(*([*range(count)] + [None] * may_rest if robot in robots else [None]
                                   for robot, count in enumerate(self.counts)))

    def left(self, choice, attacks):
        """Returns the smallest value of `choice` after an attack on at most `attacks` robots."""
        return min(self.value(tuple(None if robot in attacked else row for robot, row in enumerate(choice)))
                   for count in range(attacks + 1)
                   for attacked in itertools.combinations(range(len(choice)), count))

    def gains(self, choice, robot):
        """Returns, for each candidate of `robot`, the value of `choice` if the robot takes this candidate."""
        return [self.value(choice[:robot] + (row,) + choice[robot + 1:]) for row in range(self.counts[robot])]


class Case(unittest.TestCase):
    def decide(self, algorithm, **options):
        decision = vantage.decide(team(), algorithm, **{**FEW, **options})
        reference = Reference(decision, options.get("measure", "mutual"))
        choice = tuple(decision.choice)
        self.assertAlmostEqual(decision.value, reference.value(choice), delta=1e-6)
        return decision, reference, choice

    def descends(self, reference, choice, order):
        """Checks that each robot of `order` in turn chose its best candidate, given the choices before it."""
        before = (None,) * len(choice)
        for robot in order:
            gains = reference.gains(before, robot)
            self.assertAlmostEqual(gains[choice[robot]], max(gains), delta=1e-6)
            before = before[:robot] + (choice[robot],) + before[robot + 1:]


class Decided(Case):
    def test_coordinate_descent_adds_the_best_candidate_per_robot(self):
        for order in ((0, 1, 2), (2, 0, 1)):
            _, reference, choice = self.decide("coordinate_descent", order=order)
            self.assertEqual(reference.counts, [6, 6, 6])
            self.descends(reference, choice, order)
        _, _, choice = self.decide("coordinate_descent", order=[1])
        self.assertEqual([row is None for row in choice], [True, False, True])

    def test_further_rounds_reach_a_single_robot_optimum(self):
        decision, reference, choice = self.decide("coordinate_descent", rounds_max=20)
        for robot in range(3):
            self.assertLessEqual(max(reference.gains(choice, robot)), decision.value + 1e-6)

    def test_greedy_adds_the_best_candidate_of_all_robots(self):
        decision, reference, _ = self.decide("greedy")
        choice = (None,) * 3
        for _ in range(3):
            choice = max((choice[:robot] + (row,) + choice[robot + 1:]
                          for robot in range(3) if choice[robot] is None for row in range(reference.counts[robot])),
                         key=reference.value)
        self.assertAlmostEqual(decision.value, reference.value(choice), delta=1e-6)

    def test_local_search_requires_a_minimum_improvement(self):
        for algorithm in ("local_search", "distributed_local_search"):
            decision, reference, _ = self.decide(algorithm, alpha=1e9)  # then no change is large enough
            self.assertEqual(decision.choice.count(None), 2)
            alone = max(max(reference.gains((None,) * 3, robot)) for robot in range(3))
            self.assertAlmostEqual(decision.value, alone, delta=1e-6)
            self.assertEqual(decision.messages > 0, algorithm == "distributed_local_search")
            self.assertEqual(self.decide(algorithm)[2].count(None), 0)

    def test_exhaustive_search_finds_the_optimum(self):
        for measure in ("mutual", "logdet"):
            decision, reference, _ = self.decide("exhaustive", measure=measure)
            self.assertAlmostEqual(decision.value, max(map(reference.value, reference.choices())), delta=1e-6)
            self.assertEqual(decision.bound, decision.value)
            self.assertEqual(decision.oracle_calls, 7**3)

    def test_value_is_at_most_its_bound(self):
        best = self.decide("exhaustive")[0].value
        for algorithm in CHOOSING:
            decision = self.decide(algorithm)[0]
            self.assertLessEqual(decision.value, best + 1e-6)
            self.assertGreaterEqual(decision.value, best / 2 - 1e-4)
            self.assertGreaterEqual(decision.bound, best - 1e-6)
        self.assertIsNone(self.decide("greedy", measure="logdet")[0].bound)

    def test_value_is_at_most_the_paths_bound_with_and_without_attacks(self):
        for measure in ("mutual", "logdet"):
            for algorithm in (*CHOOSING, "rain", "max_min"):
                attacks = 1 if algorithm in ("rain", "max_min") else 0
                decision = self.decide(algorithm, measure=measure, **({"attacks_max": 1} if attacks else {}))[0]
                coarse, fine = (decision.paths_bound(nodes=nodes) for nodes in (1_000_000, 4_000_000))
                self.assertLessEqual(decision.value, fine)
                self.assertLessEqual(fine, coarse)
                self.assertLess(fine, 3 * decision.value)
                for count in (1, 2, 3):
                    self.assertLessEqual(decision.worst_attack(count)[1], decision.paths_bound(count, 1_000_000) + 1e-6)
        for argument in ({"attacks_max": -1}, {"nodes": 0}):
            with self.assertRaisesRegex(ValueError, next(iter(argument))):
                decision.paths_bound(**argument)

    def test_plans_are_feasible(self):
        problems = team()
        decision = vantage.decide(problems, **FEW)
        for problem, row, own, controls, states in zip(
                problems, decision.choice, decision.candidates, decision.controls, decision.states):
            self.assertEqual(controls.tolist(), own[row].tolist())
            pose = problem.start
            for control, state in zip(problem.controls[controls], states):
                pose = vantage.step_unicycle(pose, control, problem.step_s)
                numpy.testing.assert_allclose(pose, state, atol=1e-9)

    def test_is_reproducible_and_accepts_dicts(self):
        for algorithm in vantage.team_algorithms():
            one, again = (vantage.decide(problems, algorithm, **FEW)
                          for problems in (team(), [spec(start) for start in STARTS]))
            self.assertEqual((one.algorithm, one.value, one.choice), (algorithm, again.value, again.choice))
            self.assertEqual([each.tobytes() for each in one.states], [each.tobytes() for each in again.states])


class WithCosts(unittest.TestCase):
    def test_value_subtracts_the_motion_cost(self):
        costs = {"price_nats": 0.05, "move_cost": 1.0}  # every control of these problems moves
        for algorithm in CHOOSING:
            decision = vantage.decide(team(), algorithm, energy=costs, **FEW)
            moving = sum(row is not None for row in decision.choice)
            information = Reference(decision).value(tuple(decision.choice))
            self.assertAlmostEqual(decision.value, information - 0.05 * STEPS * moving, delta=1e-6)

    def test_robot_with_a_high_price_does_not_move(self):
        dear, free = {"price_nats": 1e6, "move_cost": 1}, {}
        decision = vantage.decide(team(), energy=[dear, free, dear], **FEW)
        self.assertEqual([row is None for row in decision.choice], [True, False, True])
        self.assertEqual([len(each) for each in decision.controls], [0, STEPS, 0])
        self.assertEqual([each.shape for each in decision.states], [(0, 3), (STEPS, 3), (0, 3)])


class Attacked(Case):
    def test_without_attacks_equals_coordinate_descent(self):
        decision, _, choice = self.decide("resilient")
        self.assertEqual(choice, self.decide("coordinate_descent")[2])
        self.assertEqual(decision.bait, [])

    def test_bait_has_the_best_stand_alone_value_and_is_ignored_by_others(self):
        for algorithm, attacks in itertools.product(("resilient", "resilient_exhaustive"), (1, 2, 3)):
            decision, reference, choice = self.decide(algorithm, attacks_max=attacks)
            alone = [max(reference.gains((None,) * 3, robot)) for robot in range(3)]
            self.assertEqual(set(decision.bait), set(sorted(range(3), key=lambda robot: -alone[robot])[:attacks]))
            for robot in decision.bait:
                self.assertAlmostEqual(reference.gains((None,) * 3, robot)[choice[robot]], alone[robot], delta=1e-6)
            rest = [robot for robot in range(3) if robot not in decision.bait]
            if algorithm == "resilient":
                self.descends(reference, choice, rest)
            else:
                without = tuple(row if robot in rest else None for robot, row in enumerate(choice))
                self.assertAlmostEqual(reference.value(without),
                                       max(map(reference.value, reference.choices(robots=rest))), delta=1e-6)

    def test_worst_attack_equals_exhaustive_attack(self):
        for attacks in (0, 1, 2):
            decision, reference, choice = self.decide("max_min", attacks_max=attacks)
            robots, value = decision.worst_attack(attacks)
            self.assertAlmostEqual(value, reference.left(choice, attacks), delta=1e-6)
            self.assertLessEqual(len(robots), attacks)
            best = max(reference.left(each, attacks) for each in reference.choices(may_rest=False))
            self.assertAlmostEqual(value, best, delta=1e-6)
            for algorithm in ("resilient", "resilient_exhaustive"):
                other = self.decide(algorithm, attacks_max=attacks)[0].worst_attack(attacks)[1]
                self.assertLessEqual(other, best + 1e-6)

    def test_first_robot_and_bait_search_alone(self):
        planner = vantage.Planner("arvi", nodes=2000)
        alone = [planner.plan(problem) for problem in team()]
        for attacks in (0, 1):
            decision, reference, _ = self.decide("rain", planner=planner, attacks_max=attacks)
            self.assertIsNone(decision.bound)
            worth = [reference.value((None,) * robot + (0,) + (None,) * (2 - robot)) for robot in range(3)]
            first = next(robot for robot in range(3) if robot not in decision.bait)
            for robot in {first, *decision.bait}:
                self.assertEqual(decision.states[robot].tobytes(), alone[robot].states.tobytes())
            if attacks:
                self.assertEqual(len(decision.bait), 1)
                self.assertGreaterEqual(worth[decision.bait[0]], worth[first] - 1e-6)
        self.assertEqual(vantage.decide(team(), "rain", nodes=2000).value,
                         vantage.decide(team(), "rain", planner=vantage.Planner(nodes=2000)).value)


class Refused(unittest.TestCase):
    def test_options_without_effect_or_beyond_limits(self):
        for words, algorithm, options in (
                ("algorithm: must be one of coordinate_descent, greedy, .*, got best", "best", {}),
                ("attacks_max: is an option of resilient, .*, rain, not of greedy", "greedy", {"attacks_max": 1}),
                ("attacks_max: must be ≥ 0 and ≤ the number of robots \\(3\\), got 4", "resilient", {"attacks_max": 4}),
                ("order: is an option of coordinate_descent, not of max_min", "max_min", {"order": [0]}),
                ("order: must contain robots from 0 to 2, got 3", "coordinate_descent", {"order": [0, 3]}),
                ("order: must contain each robot at most once, has 1 twice", "coordinate_descent", {"order": [1, 1]}),
                ("rounds_max: must be ≥ 1, got 0", "coordinate_descent", {"rounds_max": 0}),
                ("alpha: must be > 0, got -1", "local_search", {"alpha": -1.0}),
                ("nodes: must be ≥ 1, got 0", "greedy", {"nodes": 0}),
                ("epsilon: must be ≥ 0", "greedy", {"epsilon": float("nan")}),
                ("measure: must be one of logdet, mutual, got trace", "greedy", {"measure": "trace"}),
                ("planner: is an option of rain, not of greedy", "greedy", {"planner": vantage.Planner(nodes=1)}),
                ("energy: must be one of move_cost, price_nats, .*, got fuel", "greedy", {"energy": {"fuel": 1.0}}),
                ("energy: move_cost: must be ≥ 0, got -1", "greedy", {"energy": {"move_cost": -1}}),
                ("energy: must have one entry per robot \\(3\\), got 1", "greedy", {"energy": [{}]}),
                ("energy: is an option of .*, not of rain", "rain", {"energy": {"move_cost": 1.0}}),
                ("candidates_max: requires the evaluation of .* choices", "exhaustive", {"candidates_max": 200})):
            with self.subTest(words), self.assertRaisesRegex(vantage.UsageError, words):
                vantage.decide(team(), algorithm, **{**FEW, **options})

    def test_invalid_teams(self):
        def changed(key, value):
            return [*team(), {**spec(STARTS[0]), key: value}]
        moved = team()
        moved[1].set_beliefs(moved[1].means + 0.5, moved[1].covariances)
        for words, problems in (("problems: must contain at least one robot", []),
                                (r"problems\[3\]: T: must be equal to problems\[0\]", changed("T", STEPS - 1)),
                                (r"problems\[3\]: tau: must be equal to problems\[0\]", changed("tau", 1.0)),
                                (r"problems\[3\]: cost: must be logdet", changed("cost", "trace")),
                                (r"problems\[1\]: targets and their beliefs: must be equal to", moved)):
            with self.assertRaisesRegex(vantage.UsageError, words):
                vantage.decide(problems)
        with self.assertRaisesRegex(vantage.StartupError, r"problem:\d+: T: must be at least 1"):
            vantage.decide([{**spec(STARTS[0]), "T": 0}])

    def test_too_many_attacks_for_an_exhaustive_search(self):
        decision = vantage.decide(40 * team()[:1], **FEW)
        with self.assertRaisesRegex(vantage.UsageError, "attacks_max: requires the evaluation of .* choices"):
            decision.worst_attack(10)


if __name__ == "__main__":
    unittest.main()
