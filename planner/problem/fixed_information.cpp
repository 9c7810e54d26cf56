#include "planner/problem/fixed_information.hpp"

#include "planner/problem/look.hpp"

namespace vantage::planner {

std::vector<std::vector<models::PositionMatrix>> fixed_information(
    const SearchProblem& problem, const std::vector<FixedTeammate>& teammates) {
  const std::size_t steps = static_cast<std::size_t>(problem.horizon_steps);
  std::vector<std::vector<models::PositionMatrix>> fixed(problem.targets.size());
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const SearchTarget& target = problem.targets[m];
    const int p = target.model.position_dim;
    models::StateVector mean = target.prior.mean;
    fixed[m].assign(steps, models::PositionMatrix::Zero(p, p));
    for (std::size_t t = 0; t < steps; ++t) {
      mean = target.model.expected(mean, problem.step_s);
      const models::PositionVector position_m = mean.head(p);
      const Time when =
          problem.start_time + from_seconds(static_cast<double>(t + 1) * problem.step_s);
      for (const FixedTeammate& teammate : teammates) {
        if (teammate.jammed) {
          continue;
        }
        const models::Viewpoint from{models::at(teammate.trajectory, when).world_from_body,
                                     teammate.trajectory.height_m};
        fixed[m][t] += look(sight_world(problem), {&teammate.sensor, 1}, from, position_m);
      }
    }
  }
  return fixed;
}

}  // namespace vantage::planner
