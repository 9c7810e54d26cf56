#pragma once

#include <cstddef>
#include <optional>

#include "models/plan/plan.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Motion that a robot flies when the plan of a slot begins, whatever that plan is.
struct Commitment {
  enum class Known {
    kMotion,
    kNoPose,       ///< its pose was never received
    kUnknownPlan,  ///< it flies a plan from before its planner's restart
  };
  Known known = Known::kMotion;
  models::Trajectory motion;  ///< from t_{k+1} on; only if kMotion
  bool is_off_plan = false;   ///< off its plan by more than the tolerance
};

/// Returns the commitment of robot `robot` (by index) in the slot of `inputs`: the rest of its last
/// plan, or a hover at the vehicle's position if it holds off its plan or is far from it. A robot
/// without a plan hovers at its observed pose, once it cannot be flying a plan from before a
/// restart.
Commitment commitment_of(const scenario::Scenario& scenario, std::size_t robot,
                         const PlanInputs& inputs);

}  // namespace vantage::planner
