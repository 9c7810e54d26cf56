#include <cmath>

#include "models/target/kinds/kinds.hpp"

// A target whose noise grows while it is not seen: y' = y + w, W = q k I, q in m². k: steps since
// the target was last seen, at the start of the step. Source: dissertation, section 4.F.3.

namespace vantage::models::target_kinds {
namespace {

// Returns Σ j over integers j < k, interpolated linearly between integers.
double sum_of_steps(double steps) {
  const double whole = std::floor(steps);
  return 0.5 * whole * (whole - 1.0) + whole * (steps - whole);
}

TargetModel planned_as_random_walk(const TargetModel& model, double steps_unseen, double step_s) {
  constexpr double kRounding = 1e-6;  // times are rounded to microseconds
  TargetModel planned = model;
  planned.kind = TargetKind::kRandomWalk;
  planned.q *= std::floor(steps_unseen + kRounding) / step_s;
  return planned;
}

}  // namespace

constinit const TargetLaw growing_uncertainty{
    .name = "growing_uncertainty",
    .uses_q = true,
    .process_noise =
        [](const TargetModel& model, double /*dt_s*/, int steps_unseen) {
          return StateMatrix(model.q * steps_unseen *
                             StateMatrix::Identity(model.dim(), model.dim()));
        },
    .unseen_noise =
        [](const TargetModel& model, double from_steps, double to_steps) {
          return StateMatrix(model.q * (sum_of_steps(to_steps) - sum_of_steps(from_steps)) *
                             StateMatrix::Identity(model.dim(), model.dim()));
        },
    .as_planned = planned_as_random_walk};

}  // namespace vantage::models::target_kinds
