#pragma once

#include <cstddef>
#include <optional>

#include "models/plan/plan.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Motion that a robot flies when the plan of a slot begins; it does not depend on that plan.
struct Commitment {
  enum class Known {
    kMotion,
    kNoPose,       ///< the robot's pose was never received
    kUnknownPlan,  ///< the robot flies a plan that was made before its planner restarted
  };
  Known known = Known::kMotion;
  models::Trajectory motion;  ///< motion from t_{k+1} on; valid only for kMotion
  bool is_off_plan = false;   ///< the robot is farther from its plan than the tolerance
};

/// Returns the commitment of robot `robot` (by index) in the slot of `inputs`: the remaining part
/// of its last plan. If the vehicle holds away from its plan or is far from it, the commitment is a
/// hover at the vehicle's position. A robot without a plan is assumed to hover at its observed
/// pose. If it may still fly a plan from before a restart, the result is kUnknownPlan.
Commitment commitment_of(const scenario::Scenario& scenario, std::size_t robot,
                         const PlanInputs& inputs);

}  // namespace vantage::planner
