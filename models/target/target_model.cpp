#include "models/target/target_model.hpp"

#include <cmath>

#include "models/target/law.hpp"

namespace vantage::models {

bool TargetModel::has_velocity() const { return kind.law().has_velocity; }

int TargetModel::dim() const { return has_velocity() ? 4 : position_dim; }

StateMatrix TargetModel::transition(double dt_s) const {
  const TargetLaw& law = kind.law();
  return law.transition != nullptr ? law.transition(*this, dt_s)
                                   : StateMatrix(StateMatrix::Identity(dim(), dim()));
}

StateVector TargetModel::expected(const StateVector& y, double dt_s) const {
  const StateMatrix A = transition(dt_s);
  const TargetLaw& law = kind.law();
  if (law.center_m == nullptr) {
    return A * y;
  }
  const Eigen::Vector2d center_m = law.center_m(*this);
  StateVector away = y;
  away.head<2>() -= center_m;
  away = (A * away).eval();
  away.head<2>() += center_m;
  return away;
}

StateMatrix TargetModel::process_noise(double dt_s, int steps_unseen) const {
  return kind.law().process_noise(*this, dt_s, steps_unseen);
}

StateMatrix TargetModel::grown_noise(double from_steps, double to_steps) const {
  return kind.law().unseen_noise(*this, from_steps, to_steps);
}

TargetModel TargetModel::as_planned(double steps_unseen, double step_s) const {
  const TargetLaw& law = kind.law();
  return law.as_planned != nullptr ? law.as_planned(*this, steps_unseen, step_s) : *this;
}

std::optional<std::string_view> broken_rule(const TargetModel& model) {
  if (model.position_dim != 2 && (model.position_dim != 3 || model.has_velocity())) {
    return "position_dim: must be 2, or 3 for a model without velocity";
  }
  if (!(model.q >= 0.0) || !std::isfinite(model.q)) {
    return "q: must be ≥ 0";
  }
  const TargetLaw& law = model.kind.law();
  return law.broken_rule != nullptr ? law.broken_rule(model) : std::nullopt;
}

}  // namespace vantage::models
