"""Target models, costs, filters and planners written in Python. They are slow: use them to try new ideas.

A target model is any object with transition(dt_s) and process_noise(dt_s), both (n, n), like
vantage.TargetModel. If the object also has expected(mean, dt_s), it may be nonlinear; transition(dt_s, mean=mean)
is then the Jacobian at `mean`. n is the dimension of the scenario's model; the state begins with the position.

    trial = vantage.Trial(scenario,
                          filters={r: own.Filter(scenario, r, model=Mine()) for r in scenario.robots},
                          planners={r: own.Search(scenario, r, model=Mine(), cost=mine)
                                    for r in scenario.robots})

A search of 12 steps with 5 controls and 5 targets takes at least 0.05 s. The stack's own search generates
ten thousand nodes in 0.01 s.
"""
import numpy

from . import _vantage

__all__ = ["Filter", "Search", "uncertainty"]


def uncertainty(pose, beliefs, step):
    """Returns the stage cost that the stack uses: the sum of log det Σ over the targets, nats."""
    return sum(numpy.linalg.slogdet(covariance)[1] for _, covariance in beliefs.values())


def _predict(model, mean, covariance, dt_s):
    """Returns (mean, covariance) after dt_s, for a model of the stack or one written in Python."""
    if isinstance(model, _vantage.TargetModel):
        return _vantage.predict(mean, covariance, model, dt_s)
    if hasattr(model, "expected"):
        A, after = model.transition(dt_s, mean=mean), model.expected(mean, dt_s)
    else:
        A = numpy.asarray(model.transition(dt_s))
        after = A @ mean
    covariance = A @ covariance @ A.T + model.process_noise(dt_s)
    return after, (covariance + covariance.T) / 2


class Filter:
    """Filter of one robot's target beliefs with a custom target model: for Trial(filters=…).

    Kalman filter of the scans that the robot receives. A target is known from its first detection on, with a
    velocity deviation of prior_velocity_sigma_mps.
    """

    def __init__(self, scenario, robot, model=None, prior_velocity_sigma_mps=0.5):
        self.model = scenario.target_model if model is None else model
        self.sensor = scenario.sensor(robot)
        self.dim = scenario.target_model.dim
        self.prior = numpy.full(self.dim, prior_velocity_sigma_mps**2)
        self.prior[:scenario.target_model.position_dim] = 100.0
        self.beliefs = {}
        self.time_s = None

    def __call__(self, looks, time_s):
        """Returns {id: (mean, covariance)} at time_s, after the scans [(viewpoint, [(id, z, V), …]), …]."""
        dt_s = 0.0 if self.time_s is None else time_s - self.time_s
        self.time_s = time_s
        if dt_s > 0.0:
            self.beliefs = {i: _predict(self.model, *belief, dt_s) for i, belief in self.beliefs.items()}
        for viewpoint, seen in looks:
            for i, z, V in seen:
                first = self._first(viewpoint, z)
                if i in self.beliefs or first is not None:
                    mean, covariance, _ = _vantage.measure(*self.beliefs.get(i, first), self.sensor, viewpoint, z, V)
                    self.beliefs[i] = mean, covariance
        return self.beliefs

    def _first(self, viewpoint, z):
        """Returns the prior of a target at its first detection; None if z alone does not determine a position."""
        dim = 3 if self.dim == 3 else 2
        position = self.sensor.position_from(viewpoint, z, dim)
        if position is None:
            return None
        mean = numpy.zeros(self.dim)
        mean[:dim] = position
        return mean, numpy.diag(self.prior)


class Search:
    """A beam search with a custom target model and stage cost: for Trial(planners=…).

    cost(pose (3,), beliefs {id: (mean, covariance)}, step 1…T) is summed over the steps and minimised. Each step
    keeps the `width` best paths. Paths keep the scenario's margin to walls, and `separation_m` to the predicted
    positions of teammates. The robot checks every result again.

    A custom planner is any function with the same argument, a dict with robot, round, time_s (start of the plan,
    since the Unix epoch), pose (3,) and speed_mps at that time, height_m, horizon_steps, step_s, controls (U, 2),
    beliefs {id: (mean, covariance)} predicted to that time by the scenario's model, and team
    {robot: poses (T + 1, 3)}.
    """

    def __init__(self, scenario, robot, model=None, cost=uncertainty, width=4, separation_m=1.2):
        self.model = scenario.target_model if model is None else model
        self.sensor = scenario.sensor(robot)
        self.world = scenario.world
        self.clearance_m = scenario.clearance_m(robot) + 0.05
        self.cost, self.width, self.separation_m = cost, width, separation_m

    def __call__(self, question):
        """Returns rows (T, 3) of speed, yaw rate and duration; None if every path leads to a collision."""
        step_s = question["step_s"]
        height_m = question["height_m"]
        paths = [(0.0, question["pose"], question["beliefs"], [])]
        for step in range(1, question["horizon_steps"] + 1):
            successors = []
            for cost, pose, beliefs, path in paths:
                predicted = {i: _predict(self.model, *belief, step_s) for i, belief in beliefs.items()}
                for control in question["controls"]:
                    after = self._drive(pose, control, step, question)
                    if after is not None:
                        seen = {i: self._look(after, height_m, *belief) for i, belief in predicted.items()}
                        successors.append((cost + self.cost(after, seen, step), after, seen, path + [(*control, step_s)]))
            if not successors:
                break
            paths = sorted(successors, key=lambda entry: entry[0])[:self.width]
        path = paths[0][3]
        return numpy.array(path) if path else None

    def _drive(self, pose, control, step, question):
        """Returns the pose after one step; None if the pose, the path to it or the stop after it is in collision."""
        half_s = question["step_s"] / 2
        stop_m = control[0]**2 / 4  # m; stopping distance at 2 m/s²
        along = [_vantage.step_unicycle(pose, control, half_s)]
        along.append(_vantage.step_unicycle(along[0], control, half_s))
        ahead = numpy.array([numpy.cos(along[1][2]), numpy.sin(along[1][2])])
        points = [along[0][:2], along[1][:2], along[1][:2] + stop_m / 2 * ahead, along[1][:2] + stop_m * ahead]
        if any(self.world.clearance_m(point) < self.clearance_m for point in points):
            return None
        for poses in question["team"].values():
            if numpy.hypot(*(along[1] - poses[min(step, len(poses) - 1)])[:2]) < self.separation_m:
                return None
        return along[1]

    def _look(self, pose, height_m, mean, covariance):
        """Returns a belief after the expected observation of the sensor from `pose`."""
        viewpoint = numpy.array([pose[0], pose[1], height_m, pose[2]])
        n = 3 if len(mean) == 3 else 2
        position = mean[:n]
        if not self.sensor.in_view(viewpoint, position) or not self.world.line_of_sight(pose[:2], position[:2]):
            return mean, covariance
        information = numpy.linalg.inv(covariance)
        information[:n, :n] += self.sensor.information(viewpoint, position)
        after = numpy.linalg.inv(information)
        return mean, (after + after.T) / 2
