"""The environments' tasks in plain numpy, as a user would write them: reference for speed and results.

Motion, sensors, filters, rewards and observations are the same as in the library, vectorised over targets,
beams and cells where possible. The random numbers differ. At a wall this code mirrors only a belief's mean,
which is less work than the library's moments of the reflected Gaussian.
"""
import numpy

PI = numpy.pi


def wrap(angle):
    return (angle + PI) % (2 * PI) - PI


def step_unicycle(poses, controls, step_s):
    """Returns the poses (N, 3) after the controls (N, 2)."""
    speed, rate = controls[:, 0], controls[:, 1]
    half = 0.5 * rate * step_s
    chord = speed * step_s * numpy.sinc(half / PI)
    out = poses.copy()
    out[:, 0] += chord * numpy.cos(poses[:, 2] + half)
    out[:, 1] += chord * numpy.sin(poses[:, 2] + half)
    out[:, 2] = wrap(poses[:, 2] + rate * step_s)
    return out


def team_observation(poses, robot, low, high, jammed):
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    x, y, yaw = poses[robot]
    self_part = [(x - middle[0]) / half[0], (y - middle[1]) / half[1], numpy.cos(yaw), numpy.sin(yaw),
                 float(jammed[robot])]
    others = numpy.delete(poses, robot, axis=0)
    turn = numpy.array([[numpy.cos(yaw), numpy.sin(yaw)], [-numpy.sin(yaw), numpy.cos(yaw)]])
    places = (others[:, :2] - poses[robot, :2]) @ turn.T / (2 * numpy.linalg.norm(half))
    headings = others[:, 2] - yaw
    mates = numpy.column_stack([places, numpy.cos(headings), numpy.sin(headings)])
    return numpy.concatenate([self_part, mates.ravel()])


class Jammer:
    def __init__(self, robots, attacks, period, random):
        self.attacks, self.period, self.random = attacks, period, random
        self.jammed, self.seen = numpy.zeros(robots, bool), numpy.zeros(robots)
        self.choose()

    def choose(self):
        self.jammed[:] = False
        order = self.random.permutation(len(self.seen))
        order = order[numpy.argsort(-self.seen[order], kind="stable")]
        self.jammed[order[:self.attacks]] = True
        self.seen[:] = 0


class Tracking:
    """The tracking task of vantage.env with its defaults and detection_probability 0."""

    def __init__(self, robots=1, targets=5, side_m=40.0, episode_steps=200, attacks=0, period=25):
        self.robots, self.targets, self.side_m, self.episode_steps = robots, targets, side_m, episode_steps
        self.attacks, self.period = attacks, period
        self.step_s, q = 0.5, 0.001
        self.controls = numpy.array([[v, w] for v in (1.0, 3.0) for w in (0.0, 1.0, -1.0, 3.0, -3.0)])
        t = self.step_s
        self.A = numpy.eye(4) + t * numpy.eye(4, k=2)
        block = q * numpy.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])
        self.W = numpy.kron(block, numpy.eye(2))
        self.root = numpy.linalg.cholesky(self.W)
        self.V = numpy.diag([0.15**2, numpy.radians(5.0)**2])
        self.prior = numpy.diag([1.0, 1.0, 0.02**2, 0.02**2])

    def reset(self, seed):
        self.random = numpy.random.default_rng(seed)
        random, start = self.random, 0.75 * self.side_m
        low = 0.5 * (self.side_m - start)
        self.poses = numpy.column_stack([random.uniform(low, low + start, (self.robots, 2)),
                                         random.uniform(-PI, PI, self.robots)])
        self.truth = numpy.zeros((self.targets, 4))
        self.truth[:, :2] = random.uniform(low, low + start, (self.targets, 2))
        self.means = self.truth + random.standard_normal((self.targets, 4)) * numpy.sqrt(numpy.diag(self.prior))
        self.covariances = numpy.tile(self.prior, (self.targets, 1, 1))
        self.jammer = Jammer(self.robots, self.attacks, self.period, random)
        self.steps = 0
        self.look()
        return self.observe()

    def reflect(self, states):
        for axis in range(2):
            inside = numpy.clip(states[:, axis], 0.0, self.side_m)
            out = inside != states[:, axis]
            states[out, axis] = 2 * inside[out] - states[out, axis]
            states[out, axis + 2] *= -1.0

    def step(self, actions):
        if self.steps > 0 and self.steps % self.period == 0:
            self.jammer.choose()
        self.steps += 1
        moved = step_unicycle(self.poses, self.controls[actions], self.step_s)
        # The disc must not touch a wall during the step: checked at four instants.
        clear = numpy.ones(self.robots, bool)
        for part in (0.25, 0.5, 0.75, 1.0):
            at = step_unicycle(self.poses, self.controls[actions], part * self.step_s)[:, :2]
            clear &= numpy.all((at > 0.25) & (at < self.side_m - 0.25), axis=1)
        self.poses[clear] = moved[clear]
        self.poses[~clear, 2] = moved[~clear, 2]
        self.truth = self.truth @ self.A.T + self.random.standard_normal((self.targets, 4)) @ self.root.T
        self.reflect(self.truth)
        self.means = self.means @ self.A.T
        self.covariances = self.A @ self.covariances @ self.A.T + self.W
        self.reflect(self.means)
        self.look()
        return self.observe(), -self.entropies.mean(), self.steps >= self.episode_steps

    def in_view(self, pose, points):
        offset = points - pose[:2]
        ranges = numpy.hypot(offset[:, 0], offset[:, 1])
        bearings = wrap(numpy.arctan2(offset[:, 1], offset[:, 0]) - pose[2])
        return (ranges < 10.0) & (ranges >= 0.1) & (numpy.abs(bearings) < numpy.radians(47.0)), ranges, bearings

    def look(self):
        self.is_seen = numpy.zeros(self.targets, bool)
        for robot in range(self.robots):
            if self.jammer.jammed[robot]:
                continue
            pose = self.poses[robot]
            seen, ranges, bearings = self.in_view(pose, self.truth[:, :2])
            if not seen.any():
                continue
            self.is_seen |= seen
            z = numpy.column_stack([ranges[seen] + 0.15 * self.random.standard_normal(seen.sum()),
                                    bearings[seen] + numpy.radians(5.0) * self.random.standard_normal(seen.sum())])
            self.update(pose, numpy.flatnonzero(seen), z)
        sign, log_det = numpy.linalg.slogdet(self.covariances)
        self.entropies = 0.5 * log_det + 2.0 * numpy.log(2 * PI * numpy.e)
        for robot in range(self.robots):
            self.jammer.seen[robot] += self.in_view(self.poses[robot], self.means[:, :2])[0].sum()

    def update(self, pose, at, z):
        mean, P = self.means[at], self.covariances[at]
        a = mean[:, :2].copy()
        distance = numpy.hypot(*(a - pose[:2]).T)
        wide = numpy.sqrt(P[:, 0, 0] + P[:, 1, 1]) > 0.15 * distance
        if wide.any():  # iterate from the position that z indicates
            bearing = pose[2] + z[wide, 1]
            a[wide] = pose[:2] + z[wide, :1] * numpy.column_stack([numpy.cos(bearing), numpy.sin(bearing)])
            for _ in range(3):
                a[wide] = self.corrected(pose, mean[wide], P[wide], z[wide], a[wide])[0][:, :2]
        self.means[at], self.covariances[at] = self.corrected(pose, mean, P, z, a)

    def corrected(self, pose, mean, P, z, a):
        dx, dy = (a - pose[:2]).T
        r = numpy.hypot(dx, dy)
        H = numpy.zeros((len(a), 2, 4))
        H[:, 0, 0], H[:, 0, 1], H[:, 1, 0], H[:, 1, 1] = dx / r, dy / r, -dy / r**2, dx / r**2
        expected = numpy.column_stack([r, numpy.arctan2(dy, dx) - pose[2]])
        innovation = z - expected
        innovation[:, 1] = wrap(innovation[:, 1])
        innovation += numpy.einsum("mij,mj->mi", H[:, :, :2], a - mean[:, :2])
        PHt = P @ H.transpose(0, 2, 1)
        K = PHt @ numpy.linalg.inv(H @ PHt + self.V)
        return (mean + numpy.einsum("mij,mj->mi", K, innovation),
                P - K @ PHt.transpose(0, 2, 1))

    def observe(self):
        low, high = numpy.zeros(2), numpy.full(2, self.side_m)
        out = []
        for robot in range(self.robots):
            x, y, yaw = self.poses[robot]
            turn = numpy.array([[numpy.cos(yaw), numpy.sin(yaw)], [-numpy.sin(yaw), numpy.cos(yaw)]])
            targets = numpy.column_stack([
                (self.means[:, :2] - (x, y)) @ turn.T / (numpy.sqrt(2) * self.side_m),
                self.means[:, 2:] @ turn.T / 2.0, self.entropies / 10.0, self.is_seen])
            out.append(numpy.concatenate([
                team_observation(self.poses, robot, low, high, self.jammer.jammed), targets.ravel()]))
        return numpy.clip(out, -1.0, 1.0).astype(numpy.float32)


def entropy_of(log_odds):
    p = 1.0 / (1.0 + numpy.exp(-numpy.abs(log_odds)))
    return -p * numpy.log(p) - (1 - p) * numpy.log1p(-p)


class Mapping:
    """The mapping task of vantage.env with its defaults, in a world of boxes (B, 4)."""

    def __init__(self, boxes, robots=1, side_m=16.0, patch=32, episode_steps=100, attacks=0, period=25):
        self.boxes, self.robots, self.side_m, self.patch = boxes, robots, side_m, patch
        self.episode_steps, self.attacks, self.period = episode_steps, attacks, period
        self.controls = numpy.array([[v, w] for v in (0.0, 1.0, 2.0) for w in (0.0, 1.0, -1.0, 2.0, -2.0)])
        self.step_s, self.radius, self.res = 1.0, 0.2, 0.2
        self.range_max, self.sigma, self.beams = 1.5, 0.01, 96
        self.cells = int(numpy.ceil(side_m / self.res))
        self.clamp, self.look_odds = 4.595, 2.944
        self.bearings = wrap(-PI + 2 * PI * numpy.arange(self.beams) / self.beams)

    def clearance(self, points):
        walls = numpy.minimum(points, self.side_m - points).min(axis=1)
        d = numpy.maximum(self.boxes[:, None, :2] - points, points - self.boxes[:, None, 2:])
        outside = numpy.hypot(*numpy.maximum(d, 0).transpose(2, 0, 1))
        boxes = numpy.where((d > 0).any(axis=2), outside, d.max(axis=2)).min(axis=0)
        return numpy.minimum(walls, boxes)

    def reset(self, seed):
        self.random = numpy.random.default_rng(seed)
        starts = []
        while len(starts) < self.robots:
            low, high = (0, self.side_m) if not starts else (starts[0][:2] - 3, starts[0][:2] + 3)
            at = self.random.uniform(low, high, 2)
            apart = all(numpy.hypot(*(at - other[:2])) >= 1.0 for other in starts)
            if apart and self.clearance(at[None])[0] > 0.5:
                starts.append(numpy.append(at, self.random.uniform(-PI, PI)))
        self.poses = numpy.array(starts)
        self.log_odds = numpy.zeros((self.cells, self.cells))
        self.jammer = Jammer(self.robots, self.attacks, self.period, self.random)
        self.steps = 0
        self.look()
        return self.observe()

    def step(self, actions):
        if self.steps > 0 and self.steps % self.period == 0:
            self.jammer.choose()
        self.steps += 1
        for robot in range(self.robots):
            parts = numpy.arange(1, 17)[:, None] / 16.0
            way = step_unicycle(numpy.repeat(self.poses[robot][None], 16, axis=0),
                                numpy.hstack([self.controls[actions[robot]] * parts, ])[:, :2], self.step_s)
            clear = numpy.logical_and.accumulate(self.clearance(way[:, :2]) > self.radius)
            driven = 16 if clear.all() else max(0, clear.sum() - 1)
            if driven:
                self.poses[robot] = way[driven - 1]
        learnt = self.look()
        return self.observe(), learnt, self.steps >= self.episode_steps

    def scan(self, pose):
        angle = pose[2] + self.bearings
        direction = numpy.column_stack([numpy.cos(angle), numpy.sin(angle)])
        with numpy.errstate(divide="ignore", invalid="ignore"):
            boxes = self.boxes.reshape(-1, 1, 2, 2)  # (box, 1, corner, axis)
            t = (boxes - pose[:2]) / direction[None, :, None, :]
            near, far = t.min(axis=2).max(axis=2), t.max(axis=2).min(axis=2)
            hit = (near <= far) & (far >= 0)
            distance = numpy.where(hit, numpy.maximum(near, 0), numpy.inf).min(axis=0)
            walls = numpy.where(direction > 0, self.side_m - pose[:2], -pose[:2]) / direction
        distance = numpy.minimum(distance, walls.min(axis=1))
        return numpy.minimum(distance, self.range_max) + self.sigma * self.random.standard_normal(self.beams)

    def look(self):
        learnt = 0.0
        for robot in range(self.robots):
            ranges = self.scan(self.poses[robot])
            if not self.jammer.jammed[robot]:
                gain = self.fuse(self.poses[robot], ranges)
                self.jammer.seen[robot] += gain
                learnt += gain
        return learnt

    def fuse(self, pose, ranges):
        # Traverse the cells of all beams simultaneously (Amanatides and Woo).
        angle = pose[2] + self.bearings
        direction = numpy.column_stack([numpy.cos(angle), numpy.sin(angle)])
        cell = numpy.repeat(numpy.floor(pose[None, :2] / self.res).astype(int), self.beams, axis=0)
        step = numpy.where(direction > 0, 1, -1)
        with numpy.errstate(divide="ignore"):
            delta = self.res / numpy.abs(direction)
            border = ((cell + (direction > 0)) * self.res - pose[:2]) / direction
        enter, alive = numpy.zeros(self.beams), numpy.ones(self.beams, bool)
        hits, misses = [], []
        may_hit = ranges < self.range_max - 3 * self.sigma
        while alive.any():
            exit_m = border.min(axis=1)
            met = alive & may_hit & (exit_m > ranges + 2 * self.sigma)
            hits.append(cell[met & (enter > 0)])
            missed = alive & ~met & ((enter == 0) | (0.5 * (enter + exit_m) < ranges))
            misses.append(cell[missed])
            axis = border.argmin(axis=1)
            rows = numpy.arange(self.beams)
            alive &= ~met & (exit_m < self.range_max)
            cell[rows, axis] += step[rows, axis]
            border[rows, axis] += delta[rows, axis]
            alive &= numpy.all((cell >= 0) & (cell < self.cells), axis=1)
            enter = exit_m
        change = numpy.zeros_like(self.log_odds)
        misses, hits = numpy.concatenate(misses), numpy.concatenate(hits)
        change[misses[:, 1], misses[:, 0]] = -self.look_odds
        change[hits[:, 1], hits[:, 0]] = self.look_odds
        at = numpy.nonzero(change)
        before = self.log_odds[at]
        self.log_odds[at] = numpy.clip(before + change[at], -self.clamp, self.clamp)
        return float((entropy_of(before) - entropy_of(self.log_odds[at])).sum())

    def observe(self):
        low, high = numpy.zeros(2), numpy.full(2, self.side_m)
        half = self.patch // 2
        padded = numpy.pad(2.0 / (1.0 + numpy.exp(-self.log_odds)) - 1.0, self.patch, constant_values=1.0)
        padded[padded > 0.98] = 1.0
        padded[padded < -0.98] = -1.0
        out = []
        for robot in range(self.robots):
            column, row = numpy.floor(self.poses[robot, :2] / self.res).astype(int) + self.patch - half
            out.append(numpy.concatenate([
                team_observation(self.poses, robot, low, high, self.jammer.jammed),
                padded[row:row + self.patch, column:column + self.patch].ravel()]))
        return numpy.clip(out, -1.0, 1.0).astype(numpy.float32)


def pillars(side_m=16.0):
    """Returns the boxes of the world `pillars` of vantage.env."""
    boxes = [[x, y, x + 2.0, y + 2.0]
             for row in range(4) for column in range(4)
             for x, y in [(2.27 + 5.8 * column + 0.31 * (row % 2), 2.13 + 5.8 * row + 0.37 * (column % 2))]]
    return numpy.array(boxes) * side_m / 24.0
