#pragma once

#include <string>

#include "planner/app/plan_mode.hpp"

namespace vantage::planner {

/// Mode of a team that expects attacks: before the plans, each robot publishes in PROPOSAL_R the
/// plan that it makes alone.
class ProposingMode : public PlanMode {
 public:
  explicit ProposingMode(NodeState& state) : PlanMode(state) {}
  void subscribe_to_teammate(const std::string& name) override;
  void propose(Time now) override;
};

}  // namespace vantage::planner
