#include "python/task/tracking_task.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/uniform.hpp"
#include "planner/problem/motion_table.hpp"
#include "python/task/observation.hpp"
#include "sim/random.hpp"

namespace vantage::python {
namespace {

constexpr int kTargetEntries = 6;
constexpr double kSpeedUnit_mps = 2.0;
constexpr double kEntropyUnit_nats = 10.0;

const TrackingSpec& checked(const TrackingSpec& spec) {
  const auto check = [](bool holds, const char* name, const char* rule, double value) {
    require(holds, fmt::format("{}: must be {}, got {}", name, rule, value));
  };
  constexpr int kTargetsMax = 1'000;
  check(spec.side_m > 4.0 && spec.side_m <= 1'000.0, "side_m", "> 4 and ≤ 1000", spec.side_m);
  const experiments::TargetSetting& targets = spec.targets;
  check(targets.start_side_m > 0.0 && targets.start_side_m <= spec.side_m - 4.0 * spec.radius_m,
        "start_side_m", "> 0 and at most side_m - 4 radius_m", targets.start_side_m);
  check(targets.count >= 1 && targets.count <= kTargetsMax, "targets", "≥ 1 and ≤ 1000",
        targets.count);
  check(targets.q_m2ps3 >= 0.0 && targets.q_m2ps3 <= 10.0, "q_m2ps3", "≥ 0 and ≤ 10",
        targets.q_m2ps3);
  check(targets.step_s > 0.0 && targets.step_s <= 60.0, "step_s", "> 0 and ≤ 60", targets.step_s);
  check(targets.prior_position_sigma_m > 0.0, "prior_position_sigma_m", "> 0",
        targets.prior_position_sigma_m);
  check(targets.prior_velocity_sigma_mps > 0.0, "prior_velocity_sigma_mps", "> 0",
        targets.prior_velocity_sigma_mps);
  check(targets.detection_probability >= 0.0 && targets.detection_probability < 1.0,
        "detection_probability", "≥ 0 and < 1", targets.detection_probability);
  check(spec.radius_m >= 0.0 && spec.radius_m < 1.0, "radius_m", "≥ 0 and < 1", spec.radius_m);
  check(!spec.controls.empty(), "controls", "at least one", 0.0);
  return spec;
}

}  // namespace

TrackingTask::TrackingTask(const TrackingSpec& spec)
    : TeamTask(spec.robots, spec.episode_steps, spec.jammer),
      spec_(checked(spec)),
      ground_(spec.side_m) {}

std::vector<ObservationPart> TrackingTask::observation_parts() const {
  return {{"self", {kSelfEntries}},
          {"teammates", {robots() - 1, kTeammateEntries}},
          {"targets", {spec_.targets.count, kTargetEntries}}};
}

int TrackingTask::observation_size() const {
  return kSelfEntries + kTeammateEntries * (robots() - 1) + kTargetEntries * spec_.targets.count;
}

void TrackingTask::on_reset(std::uint64_t seed) {
  std::mt19937_64 starts = sim::random_stream(seed, "task starts");
  poses_.clear();
  const double low_m = 0.5 * (spec_.side_m - spec_.targets.start_side_m);
  const double high_m = low_m + spec_.targets.start_side_m;
  for (int robot = 0; robot < robots(); ++robot) {
    const double x_m = uniform(starts, low_m, high_m);
    const double y_m = uniform(starts, low_m, high_m);
    poses_.push_back({x_m, y_m, uniform(starts, -kPi, kPi)});
  }
  targets_.emplace(spec_.targets, ground_.world, sim::random_stream(seed, "task targets")());
  update_beliefs();
}

double TrackingTask::on_step(std::span<const std::int64_t> actions) {
  for (std::size_t robot = 0; robot < poses_.size(); ++robot) {
    Pose2& pose = poses_[robot];
    const models::UnicycleControl& control = spec_.controls[index(actions[robot])];
    const double step_s = spec_.targets.step_s;
    const Pose2 next = models::step_unicycle(pose, control, step_s);
    if (planner::arc_is_clear(ground_.world, pose, control, step_s, spec_.radius_m)) {
      pose = next;
    } else {
      pose.yaw_rad = next.yaw_rad;
    }
  }
  targets_->move();
  update_beliefs();
  return -entropy_nats();
}

void TrackingTask::update_beliefs() {
  targets_->observe(spec_.sensor, poses_, jammed());
  const std::vector<models::Gaussian>& beliefs = targets_->beliefs();
  target_entropy_nats_.resize(beliefs.size());
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    target_entropy_nats_[m] = models::entropy_nats(beliefs[m]);
    for (std::size_t robot = 0; robot < poses_.size(); ++robot) {
      if (models::in_view(spec_.sensor, {poses_[robot], 0.0}, beliefs[m].mean.head(2))) {
        seen()[robot] += 1.0;
      }
    }
  }
}

double TrackingTask::entropy_nats() const {
  return std::accumulate(target_entropy_nats_.begin(), target_entropy_nats_.end(), 0.0) /
         static_cast<double>(target_entropy_nats_.size());
}

void TrackingTask::observe(int robot, std::span<float> out) const {
  ObservationWriter writer(out);
  const auto self = index(robot);
  add_team(writer, ground_.world.bounds, poses_, self, jammed()[self] != 0);
  const Pose2 body_from_world = inverse(poses_[self]);
  const double diagonal_m = std::sqrt(2.0) * spec_.side_m;
  const Pose2 body_from_north{0.0, 0.0, body_from_world.yaw_rad};
  const std::vector<models::Gaussian>& beliefs = targets_->beliefs();
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    const models::StateVector& mean = beliefs[m].mean;
    const Eigen::Vector2d place_m = body_from_world * Eigen::Vector2d(mean.head<2>());
    const Eigen::Vector2d velocity_mps = body_from_north * Eigen::Vector2d(mean.tail<2>());
    writer.add(place_m.x() / diagonal_m);
    writer.add(place_m.y() / diagonal_m);
    writer.add(velocity_mps.x() / kSpeedUnit_mps);
    writer.add(velocity_mps.y() / kSpeedUnit_mps);
    writer.add(target_entropy_nats_[m] / kEntropyUnit_nats);
    writer.add(targets_->is_seen()[m] != 0 ? 1.0 : 0.0);
  }
}

}  // namespace vantage::python
