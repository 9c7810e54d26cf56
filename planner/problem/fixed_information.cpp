#include "planner/problem/fixed_information.hpp"

#include <algorithm>

#include "core/infinity.hpp"
#include "planner/problem/information_at.hpp"

namespace vantage::planner {
namespace {

struct View {
  models::Viewpoint from;
  const models::SensorModel* sensor = nullptr;
};

// Returns the bounding box of the expected target positions over the plan.
models::Rectangle around_targets(const SearchProblem& problem) {
  models::Rectangle bounding_box{Eigen::Vector2d::Constant(kInfinity),
                                 Eigen::Vector2d::Constant(-kInfinity)};
  for (const SearchTarget& target : problem.targets) {
    models::StateVector mean = target.prior.mean;
    for (int t = 0; t <= problem.horizon_steps; ++t) {  // the mean's path can be a curve
      const Eigen::Vector2d at_m = mean.head<2>();
      bounding_box.min_m = bounding_box.min_m.cwiseMin(at_m);
      bounding_box.max_m = bounding_box.max_m.cwiseMax(at_m);
      mean = target.model.expected(mean, problem.step_s);
    }
  }
  return bounding_box;
}

// False if no target is in range from any point of the teammate's path, as for most teammates in a
// large team.
bool may_see(const FixedTeammate& teammate, const models::Rectangle& bounding_box) {
  constexpr double kSlack_m = 1e-3;
  const Eigen::Array2d within_m = Eigen::Array2d::Constant(
      models::length_at_most_m(teammate.trajectory) + teammate.sensor.range_max_m + kSlack_m);
  const Eigen::Array2d from_m = teammate.trajectory.start.position_m().array();
  return !((from_m + within_m < bounding_box.min_m.array()).any() ||
           (from_m - within_m > bounding_box.max_m.array()).any());
}

}  // namespace

std::vector<std::vector<models::StateMatrix>> fixed_information(
    const SearchProblem& problem, const std::vector<FixedTeammate>& teammates) {
  const auto steps = static_cast<std::size_t>(problem.horizon_steps);
  // Each teammate's viewpoints, [step][teammate], computed once for all targets.
  const models::Rectangle bounding_box = around_targets(problem);
  std::vector<std::vector<View>> views(steps);
  for (const FixedTeammate& teammate : teammates) {
    if (teammate.jammed || !may_see(teammate, bounding_box)) {
      continue;
    }
    for (std::size_t t = 0; t < steps; ++t) {
      const Time when =
          problem.start_time + from_seconds(static_cast<double>(t + 1) * problem.step_s);
      views[t].push_back(
          {{models::at(teammate.trajectory, when).world_from_body, teammate.trajectory.height_m},
           &teammate.sensor});
    }
  }
  const bool measures_velocity =
      std::any_of(teammates.begin(), teammates.end(),
                  [](const FixedTeammate& each) { return models::measures_velocity(each.sensor); });
  std::vector<std::vector<models::StateMatrix>> fixed(problem.targets.size());
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const SearchTarget& target = problem.targets[m];
    const int p = target.model.position_dim;
    models::StateVector mean = target.prior.mean;
    const bool is_of_state = measures_velocity && target.model.has_velocity();
    const int n = is_of_state ? target.model.dim() : p;
    fixed[m].assign(steps, models::StateMatrix::Zero(n, n));
    for (std::size_t t = 0; t < steps; ++t) {
      mean = target.model.expected(mean, problem.step_s);
      const models::PositionVector position_m = mean.head(p);
      for (const View& view : views[t]) {
        if (is_of_state) {
          fixed[m][t] +=
              state_information_at(sight_world(problem), {view.sensor, 1}, view.from, mean);
        } else {
          fixed[m][t] +=
              information_at(sight_world(problem), {view.sensor, 1}, view.from, position_m);
        }
      }
    }
  }
  return fixed;
}

}  // namespace vantage::planner
