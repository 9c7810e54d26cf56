#include "planner/robot/closing_check.hpp"

namespace vantage::planner {
namespace {

// Tolerance of the closing check. It covers rounding, and the different pieces into which the
// search and the check divide arcs.
constexpr double kRounding_m = 0.02;

}  // namespace

bool keeps_apart(const SearchProblem& problem, const models::Trajectory& motion,
                 double rounding_m) {
  for (std::size_t i = 0; i < problem.teammates.size(); ++i) {
    if (!models::keeps_separation(motion, problem.teammates[i], motion.start_time,
                                  required_separation_m(problem, i) - rounding_m,
                                  models::kPlanPiece_s, problem.separation_from_above)) {
      return false;
    }
  }
  return true;
}

bool is_safe(const SearchProblem& problem, const models::Trajectory& motion) {
  return models::is_clear(*problem.world, motion, motion.start_time,
                          problem.clearance_m - kRounding_m) &&
         keeps_apart(problem, motion, kRounding_m);
}

std::optional<std::size_t> nearest_violating_teammate(const SearchProblem& problem) {
  std::optional<std::size_t> nearest;
  double least_m = problem.separation_m;
  for (std::size_t i = 0; i < problem.teammates.size(); ++i) {
    const double kept_m = required_separation_m(problem, i);
    if (kept_m < least_m) {
      least_m = kept_m;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace vantage::planner
