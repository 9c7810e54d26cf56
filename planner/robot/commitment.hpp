#pragma once

#include <cstddef>
#include <optional>

#include "models/plan/plan.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// What a robot flies when the plan of a slot begins, whatever that plan will be.
struct Commitment {
  enum class Known {
    kMotion,
    kNoPose,       ///< it was never seen
    kUnknownPlan,  ///< it flies a plan of before its planner's restart
  };
  Known known = Known::kMotion;
  models::Trajectory motion;  ///< from t_{k+1} on; of kMotion alone
  bool is_off_plan = false;   ///< it was seen, or holds, farther from its plan than the tolerance
};

/// The commitment of robot `robot` (by index) in the slot of `inputs`: what is left of its last
/// plan or, where the vehicle holds off it or is far from it, a hover there. A robot that has no
/// plan yet hovers where it is seen, once it cannot be flying one of before a restart.
Commitment commitment_of(const scenario::Scenario& scenario, std::size_t robot,
                         const PlanInputs& inputs);

}  // namespace vantage::planner
