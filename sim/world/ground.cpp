#include "sim/world/ground.hpp"

#include <cmath>
#include <utility>

#include "sim/rover/starts.hpp"

namespace vantage::sim {
namespace {

// Speed limit of a double integrator: the speed of the fastest target in the dissertation's
// experiments.
constexpr double kDrifterSpeedMaxMps = 2.0;

}  // namespace

Ground::Ground(const scenario::Scenario& scenario, std::uint64_t seed)
    : starts_(target_starts(scenario, seed)) {
  std::vector<RoverFleet::Start> rovers;
  std::vector<Disc> discs;
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    rovers.push_back({starts_[i], scenario.targets[i].radius_m});
    discs.push_back({starts_[i].position_m(), scenario.targets[i].radius_m});
  }
  switch (scenario.target_truth.motion) {
    case scenario::TargetMotion::kRandomWaypoint:
      rovers_.emplace(scenario.world, scenario.target_truth, rovers, seed);
      break;
    case scenario::TargetMotion::kDoubleIntegrator:
      drifters_.emplace(scenario.world, discs, scenario.target_truth.acceleration_q,
                        kDrifterSpeedMaxMps, seed);
      break;
    case scenario::TargetMotion::kStill:
      break;
  }
}

void Ground::keep_out(std::vector<Eigen::Vector2d> centres_m, double distance_m) {
  if (rovers_) {
    rovers_->keep_out(std::move(centres_m), distance_m);
  }
}

void Ground::decide(double elapsed_s) {
  if (rovers_) {
    rovers_->decide(elapsed_s);
  }
}

void Ground::step(double dt_s) {
  if (rovers_) {
    rovers_->step(dt_s);
  }
  if (drifters_) {
    drifters_->step(dt_s);
  }
}

Pose2 Ground::world_from_body(std::size_t i) const {
  if (rovers_) {
    return rovers_->state(i).world_from_body;
  }
  if (drifters_) {
    const Eigen::Vector2d& p_m = drifters_->disc(i).centre_m;
    return {p_m.x(), p_m.y(), starts_[i].yaw_rad};
  }
  return starts_[i];
}

Eigen::Vector2d Ground::velocity_mps(std::size_t i) const {
  if (rovers_) {
    const RoverState& state = rovers_->state(i);
    const double yaw_rad = state.world_from_body.yaw_rad;
    return state.speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  }
  return drifters_ ? drifters_->velocity_mps(i) : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

}  // namespace vantage::sim
