#!/usr/bin/env python3
"""Motion, sensors and beliefs in Python give the results of the C++ models."""
import math
import unittest

import numpy
import vantage


class Motion(unittest.TestCase):
    def test_follows_a_circle(self):
        pose = vantage.step_unicycle([1.0, 2.0, 0.0], [1.0, 1.0], math.pi / 2)
        numpy.testing.assert_allclose(pose, [2.0, 3.0, math.pi / 2], atol=1e-12)

    def test_vectorised_call_equals_single_calls(self):
        random = numpy.random.default_rng(1)
        poses, controls = random.normal(size=(20, 3)), random.normal(size=(20, 2))
        together = vantage.step_unicycle(poses, controls, 0.5)
        self.assertEqual(together.shape, (20, 3))
        for pose, control, after in zip(poses, controls, together):
            self.assertEqual(vantage.step_unicycle(pose, control, 0.5).tolist(), after.tolist())

    def test_one_row_gives_one_row(self):
        self.assertEqual(vantage.step_unicycle(numpy.zeros((1, 3)), numpy.ones((1, 2)), 1.0).shape, (1, 3))

    def test_refuses_other_shapes(self):
        with self.assertRaisesRegex(ValueError, "shape"):
            vantage.step_unicycle(numpy.zeros((4, 3)), numpy.zeros((3, 2)), 1.0)

    def test_has_the_primitives(self):
        self.assertEqual(vantage.standard_primitives().shape, (10, 2))
        self.assertEqual(vantage.lab_primitives()[:, 0].tolist(), 5 * [1.0])


class Target(unittest.TestCase):
    def test_double_integrator_has_its_closed_form(self):
        model = vantage.TargetModel("double_integrator", q=0.2)
        numpy.testing.assert_allclose(model.transition(0.5), numpy.eye(4) + 0.5 * numpy.eye(4, k=2))
        W = model.process_noise(0.5)
        self.assertAlmostEqual(W[0, 0], 0.2 * 0.5**3 / 3)
        self.assertAlmostEqual(W[0, 2], 0.2 * 0.5**2 / 2)
        self.assertAlmostEqual(W[2, 2], 0.2 * 0.5)

    def test_refuses_invalid_values(self):
        with self.assertRaisesRegex(vantage.UsageError, "kind: must be one of .*random_walk.*got walk"):
            vantage.TargetModel("walk")
        with self.assertRaisesRegex(vantage.UsageError, "q: must be ≥ 0"):
            vantage.TargetModel("random_walk", q=-1.0)


class Sensor(unittest.TestCase):
    def test_observes_range_and_bearing(self):
        sensor = vantage.SensorModel("range_bearing", range_max_m=10.0)
        z = sensor.observe([1.0, 1.0, 0.0, math.pi / 2], [1.0, 4.0])
        numpy.testing.assert_allclose(z, [3.0, 0.0], atol=1e-12)
        self.assertTrue(sensor.in_view([1.0, 1.0, 0.0, 0.0], [1.0, 4.0]))
        self.assertFalse(sensor.in_view([1.0, 1.0, 0.0, 0.0], [1.0, 12.0]))

    def test_jacobian_equals_finite_differences(self):
        for kind in ("position", "range", "bearing", "range_bearing"):
            sensor = vantage.SensorModel(kind)
            viewpoint, target, h = [0.3, -0.2, 0.0, 0.7], numpy.array([2.0, 1.5]), 1e-6
            differences = numpy.stack([
                (sensor.observe(viewpoint, target + h * e) - sensor.observe(viewpoint, target - h * e)) / (2 * h)
                for e in numpy.eye(2)], axis=1)
            H = sensor.jacobian(viewpoint, target)
            numpy.testing.assert_allclose(H, differences, atol=1e-8)
            V = sensor.noise_covariance(viewpoint, target)
            numpy.testing.assert_allclose(sensor.information(viewpoint, target), H.T @ numpy.linalg.inv(V) @ H)

    def test_seed_determines_the_noise(self):
        sensor = vantage.SensorModel("range", range_sigma_m=0.5)
        one, again, other = (sensor.sample([0, 0, 0, 0], [3.0, 0.0], seed)[0][0] for seed in (1, 1, 2))
        self.assertEqual(one, again)
        self.assertNotEqual(one, other)

    def test_position_from_inverts_observe_if_possible(self):
        sensor = vantage.SensorModel("range_bearing")
        z = sensor.observe([0.5, 0.5, 0.0, 0.3], [2.0, 3.0])
        numpy.testing.assert_allclose(sensor.position_from([0.5, 0.5, 0.0, 0.3], z), [2.0, 3.0], atol=1e-12)
        self.assertIsNone(vantage.SensorModel("range").position_from([0, 0, 0, 0], [3.0]))

    def test_refuses_unknown_fields(self):
        with self.assertRaisesRegex(TypeError, "no range_m"):
            vantage.SensorModel("range", range_m=3.0)
        with self.assertRaisesRegex(TypeError, "no range_rate_sigma_mps; own parameters of kind range: none"):
            vantage.SensorModel("range", range_rate_sigma_mps=0.1)
        with self.assertRaisesRegex(TypeError, "own parameters of kind range_rate: range_rate_sigma_mps"):
            vantage.SensorModel("range_rate", rate_sigma=0.1)

    def test_has_the_parameters_of_its_kind(self):
        sensor = vantage.SensorModel("range_rate", range_min_m=0.1)
        self.assertEqual(sensor.own_parameters, {"range_rate_sigma_mps": 0.1})
        sensor.range_rate_sigma_mps = 0.3
        self.assertEqual(sensor.range_rate_sigma_mps, 0.3)
        self.assertAlmostEqual(sensor.noise_covariance([0, 0, 0, 0], [2.0, 0.0])[1, 1], 0.09)
        with self.assertRaisesRegex(vantage.UsageError, "range_rate_sigma_mps: must be above 0"):
            sensor.range_rate_sigma_mps = 0.0
        sensor.range_max_m = 7.0
        self.assertEqual(sensor.range_max_m, 7.0)
        self.assertEqual(vantage.SensorModel("range").own_parameters, {})

    def test_measures_the_velocity_of_its_targets(self):
        sensor = vantage.SensorModel("range_rate", range_min_m=0.1)
        numpy.testing.assert_allclose(sensor.observe([0, 0, 1, 0], [3.0, 4.0], velocity=[1.0, 0.5]), [5.0, 1.0])
        state = numpy.array([3.0, 4.0, 1.0, 0.5])
        H = sensor.state_jacobian([0, 0, 1, 0], state)
        numeric = numpy.transpose([(sensor.observe([0, 0, 1, 0], (state + e)[:2], velocity=(state + e)[2:])
                                    - sensor.observe([0, 0, 1, 0], (state - e)[:2], velocity=(state - e)[2:])) / 2e-6
                                   for e in 1e-6 * numpy.eye(4)])
        numpy.testing.assert_allclose(H, numeric, atol=1e-6)
        V = sensor.noise_covariance([0, 0, 1, 0], state[:2])
        numpy.testing.assert_allclose(sensor.state_information([0, 0, 1, 0], state), H.T @ numpy.linalg.inv(V) @ H)


class World(unittest.TestCase):
    def test_computes_clearance_and_line_of_sight(self):
        world = vantage.World([0, 0, 10, 10], [[4, 4, 6, 6]])
        self.assertAlmostEqual(world.clearance_m([1.0, 5.0]), 1.0)
        self.assertAlmostEqual(world.clearance_m([3.5, 5.0]), 0.5)
        self.assertFalse(world.line_of_sight([1, 5], [9, 5]))
        self.assertTrue(world.line_of_sight([1, 1], [9, 1]))
        with self.assertRaisesRegex(vantage.UsageError, "obstacles"):
            vantage.World([0, 0, 10, 10], [[6, 4, 4, 6]])


class Belief(unittest.TestCase):
    model = vantage.TargetModel("double_integrator", q=0.01)
    mean, covariance = numpy.array([2.0, 1.0, 0.1, 0.0]), numpy.diag([0.01, 0.01, 0.04, 0.04])

    def test_prediction_is_linear(self):
        mean, covariance = vantage.predict(self.mean, self.covariance, self.model, 0.5)
        A = self.model.transition(0.5)
        numpy.testing.assert_allclose(mean, A @ self.mean, atol=1e-15)
        numpy.testing.assert_allclose(covariance, A @ self.covariance @ A.T + self.model.process_noise(0.5))

    def test_update_equals_a_kalman_filter(self):
        sensor = vantage.SensorModel("range_bearing", range_sigma_m=0.1, bearing_sigma_rad=0.05)
        viewpoint = [0.0, 0.0, 0.0, 0.2]
        z = sensor.observe(viewpoint, [2.03, 0.98])
        V = sensor.noise_covariance(viewpoint, [2.0, 1.0])
        mean, covariance, used = vantage.measure(self.mean, self.covariance, sensor, viewpoint, z, V)
        H = numpy.hstack([sensor.jacobian(viewpoint, self.mean[:2]), numpy.zeros((2, 2))])
        K = self.covariance @ H.T @ numpy.linalg.inv(H @ self.covariance @ H.T + V)
        self.assertTrue(used)
        numpy.testing.assert_allclose(
            mean, self.mean + K @ (z - sensor.observe(viewpoint, self.mean[:2])), atol=1e-6)
        numpy.testing.assert_allclose(covariance, (numpy.eye(4) - K @ H) @ self.covariance, atol=1e-10)

    def test_gate_rejects_distant_measurements(self):
        sensor = vantage.SensorModel("position", position_sigma_m=0.1)
        z = sensor.observe([0, 0, 0, 0], [5.0, 1.0])
        V = 0.01 * numpy.eye(len(z))
        mean, covariance, used = vantage.measure(self.mean, self.covariance, sensor, [0, 0, 0, 0], z, V, 3.0)
        self.assertFalse(used)
        self.assertEqual(mean.tolist(), self.mean.tolist())

    def test_missed_detection_moves_the_belief_out_of_view(self):
        sensor = vantage.SensorModel("range", range_max_m=2.0)
        world = vantage.World([-10, -10, 10, 10])
        mean, _ = vantage.miss([1.5, 0.0], numpy.eye(2), sensor, [0, 0, 0, 0], world, 0.9)
        self.assertGreater(mean[0], 1.7)

    def test_belief_is_confined_to_the_world(self):
        world = vantage.World([0, 0, 4, 4])
        mean, _ = vantage.confine([3.9, 2.0], 0.5 * numpy.eye(2), world)
        self.assertLess(mean[0], 3.8)

    def test_entropy_has_its_closed_form(self):
        self.assertAlmostEqual(vantage.entropy_nats(numpy.eye(2)), math.log(2 * math.pi * math.e))
        self.assertAlmostEqual(vantage.log_det(2 * numpy.eye(3)), 3 * math.log(2))

    def test_refuses_other_shapes(self):
        with self.assertRaisesRegex(ValueError, "covariance: must have the shape"):
            vantage.predict(self.mean, numpy.eye(3), self.model, 0.5)
        with self.assertRaisesRegex(ValueError, "mean: must have the shape"):
            vantage.predict([[1.0]], numpy.eye(3), self.model, 0.5)
        with self.assertRaisesRegex(vantage.UsageError, "covariance: must be positive definite"):
            vantage.measure([0, 0], -numpy.eye(2), vantage.SensorModel("range"), [0, 0, 0, 0], [1.0], [[1.0]])


if __name__ == "__main__":
    unittest.main()
