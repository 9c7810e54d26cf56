#pragma once

#include <cstddef>

#include "planner/robot/slot_planner.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Planner for planner.algorithm `external`. Does not search: its plan is the answer in the inputs
/// if the answer passes the closing check, otherwise the fallback.
class ExternalPlanner : public SlotPlanner {
 public:
  /// `scenario` must outlive this object.
  ExternalPlanner(const scenario::Scenario& scenario, std::size_t robot)
      : planner_(scenario.planner), limits_(scenario.robots[robot].limits) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;

 private:
  const scenario::PlannerSpec& planner_;
  const models::VehicleLimits& limits_;
};

}  // namespace vantage::planner
