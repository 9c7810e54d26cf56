#pragma once

#include <cstddef>

#include "planner/robot/slot_planner.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Of planner.algorithm `external`: searches nothing; its plan is the answer in the inputs, if that
/// passes the closing check, else what it falls back on.
class ExternalPlanner : public SlotPlanner {
 public:
  /// `scenario` must outlive it.
  ExternalPlanner(const scenario::Scenario& scenario, std::size_t robot)
      : planner_(scenario.planner), limits_(scenario.robots[robot].limits) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;

 private:
  const scenario::PlannerSpec& planner_;
  const models::VehicleLimits& limits_;
};

}  // namespace vantage::planner
