#include "planner/search/sighting_value.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "planner/problem/block_kernels.hpp"

namespace vantage::planner {
void SightingValue::reset(const SearchProblem& problem, const Expander& expander) {
  problem_ = &problem;
  expander_ = &expander;
  speed_max_mps_ = expander_->motion().reach_m() / problem_->step_s;
  turn_max_radps_ = 0.0;
  for (const models::UnicycleControl& control : problem_->controls) {
    turn_max_radps_ = std::max(turn_max_radps_, std::abs(control.yaw_rate_radps));
  }
  range_max_m_ = 0.0;
  half_fov_rad_ = 0.0;
  for (const models::SensorModel& sensor : problem_->sensors) {
    range_max_m_ = std::max(range_max_m_, sensor.range_max_m);
    half_fov_rad_ = std::max(half_fov_rad_, 0.5 * sensor.fov_rad);
  }
  // Gain of one measurement from half the range, straight ahead, at half the horizon.
  const BeliefTable& beliefs = expander_->beliefs();
  const int t = (problem_->horizon_steps + 1) / 2;
  for (int m = 0; m < beliefs.target_count(); ++m) {
    const BlockLayout layout = beliefs.layout(m);
    const bool spatial = layout == BlockLayout::kSpatial;
    const models::PositionVector target_m = beliefs.mean_m(m, t).head(spatial ? 3 : 2);
    PackedInformation M;
    for (const models::SensorModel& sensor : problem_->sensors) {
      const models::Viewpoint from{{target_m(0) - 0.5 * sensor.range_max_m, target_m(1), 0.0},
                                   problem_->height_m};
      double packed[kMaxPacked] = {};
      if (layout == BlockLayout::kMoving && models::measures_velocity(sensor)) {
        models::StateVector state(4);
        state << target_m, beliefs.velocity_mps(m, t);
        pack(layout, models::state_information(sensor, from, state), packed);
        M.is_of_state = true;
      } else {
        pack(spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar,
             models::information(sensor, from, target_m), packed);
      }
      for (int i = 0; i < kMaxPacked; ++i) {
        M.m[i] += packed[i];
      }
    }
    const double* block = beliefs.open_loop(m, t);
    look_values_[index(m)] = beliefs.cost() == CostKind::kTrace ? trace_reduction(layout, M, block)
                                                                : std::log(gain(layout, M, block));
  }
}

double SightingValue::value(const Pose2& pose, int t) const {
  const BeliefTable& beliefs = expander_->beliefs();
  const double steps_left = problem_->horizon_steps - t;
  double best = 0.0;
  for (int m = 0; m < beliefs.target_count(); ++m) {
    const Eigen::Vector3d& mean_m = beliefs.mean_m(m, t);
    const double dx_m = mean_m.x() - pose.x_m;
    const double dy_m = mean_m.y() - pose.y_m;
    const double way_m = std::hypot(dx_m, dy_m) - range_max_m_;
    if (way_m > steps_left * expander_->motion().reach_m()) {
      continue;
    }
    const double turn_rad =
        std::abs(wrap_to_pi(std::atan2(dy_m, dx_m) - pose.yaw_rad)) - half_fov_rad_;
    const double travel_s = speed_max_mps_ > 0.0 ? std::max(0.0, way_m) / speed_max_mps_ : 0.0;
    const double turn_s = turn_max_radps_ > 0.0 ? std::max(0.0, turn_rad) / turn_max_radps_ : 0.0;
    // The first sighting is at the next step or later; fractions of a step distinguish neighbouring
    // poses.
    const double steps = std::max(1.0, (travel_s + turn_s) / problem_->step_s);
    if (steps > steps_left) {
      continue;
    }
    best = std::max(best, look_values_[index(m)] * (steps_left + 1.0 - steps));
  }
  return best;
}

}  // namespace vantage::planner
