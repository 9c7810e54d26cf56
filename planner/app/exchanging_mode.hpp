#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planner/app/plan_mode.hpp"
#include "planner/robot/team_exchange.hpp"

namespace vantage::planner {

/// Mode of a team that uses local search: before the plans, all robots improve the team's solution
/// and exchange it as TEAM_PROPOSAL_*.
class ExchangingMode : public PlanMode {
 public:
  explicit ExchangingMode(NodeState& state) : PlanMode(state) {}
  void subscribe_to_teammate(const std::string& name) override;
  [[nodiscard]] Time next_tick() const override;
  SlotStage advance(Time now) override;
  /// Starts the exchange of the slot's round.
  void propose(Time now) override;

 private:
  void take(const models::TeamProposal& proposal);
  /// Continues the local search for a limited time and publishes its result.
  void improve(Time now);

  std::unique_ptr<TeamExchange> exchange_;  ///< last exchange that was started
  Time next_work_ = Time::max();
  Time exchange_end_{};
  std::vector<models::InputRef> inputs_;  ///< inputs of the candidates
  std::map<std::string, models::TeamProposal>
      newest_proposals_;  ///< newest proposal of each teammate
};

}  // namespace vantage::planner
