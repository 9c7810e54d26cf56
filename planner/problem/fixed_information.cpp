#include "planner/problem/fixed_information.hpp"

#include "planner/problem/look.hpp"

namespace vantage::planner {
namespace {

struct View {
  models::Viewpoint from;
  const models::SensorModel* sensor = nullptr;
};

}  // namespace

std::vector<std::vector<models::PositionMatrix>> fixed_information(
    const SearchProblem& problem, const std::vector<FixedTeammate>& teammates) {
  const auto steps = static_cast<std::size_t>(problem.horizon_steps);
  // Where each teammate looks from, [step][teammate]: once, not for each target again.
  std::vector<std::vector<View>> views(steps);
  for (std::size_t t = 0; t < steps; ++t) {
    const Time when =
        problem.start_time + from_seconds(static_cast<double>(t + 1) * problem.step_s);
    for (const FixedTeammate& teammate : teammates) {
      if (!teammate.jammed) {
        views[t].push_back(
            {{models::at(teammate.trajectory, when).world_from_body, teammate.trajectory.height_m},
             &teammate.sensor});
      }
    }
  }
  std::vector<std::vector<models::PositionMatrix>> fixed(problem.targets.size());
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const SearchTarget& target = problem.targets[m];
    const int p = target.model.position_dim;
    models::StateVector mean = target.prior.mean;
    fixed[m].assign(steps, models::PositionMatrix::Zero(p, p));
    for (std::size_t t = 0; t < steps; ++t) {
      mean = target.model.expected(mean, problem.step_s);
      const models::PositionVector position_m = mean.head(p);
      for (const View& view : views[t]) {
        fixed[m][t] += look(sight_world(problem), {view.sensor, 1}, view.from, position_m);
      }
    }
  }
  return fixed;
}

}  // namespace vantage::planner
