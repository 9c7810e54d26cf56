#pragma once

#include <string>
#include <variant>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/input_store.hpp"
#include "bus/node/node.hpp"
#include "bus/node/replay_queue.hpp"
#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Bus node that computes the plans of a log again. Each logged PLAN_R (and, with local search,
/// each TEAM_PROPOSAL_R) names its inputs and its node budget, so the same planner must give the
/// same result. Publishes its results under the bus's prefix and counts the differences.
class PlannerReplayNode : public bus::Node {
 public:
  PlannerReplayNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                    const std::string& robot);

  [[nodiscard]] std::string name() const override { return "REPLAY_PLANNER_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  enum class Outcome { kSame, kDifferent, kIncomplete };
  [[nodiscard]] bool gather(const RoundSchedule::Slot& slot,
                            const std::vector<models::InputRef>& names, PlanInputs& inputs) const;
  Outcome replay(const models::RobotPlan& logged);
  Outcome replay(const models::TeamProposal& logged);

  bus::Bus& bus_;
  scenario::Scenario scenario_;
  std::string robot_;
  RobotPlanner planner_;
  RoundSchedule schedule_;
  Time next_{};
  bus::InputStore<models::RobotBelief> beliefs_{64};
  bus::InputStore<models::BeliefMixture> mixtures_{64};
  bus::InputStore<models::RobotMap> maps_{64};
  bus::InputStore<models::MocapFrame> frames_{4'000};
  bus::InputStore<models::PoseEstimate> poses_{256};
  bus::InputStore<models::RobotPlan> plans_{64};
  bus::InputStore<models::RobotPlan> answers_{64};
  bus::InputStore<models::VehicleStatus> statuses_{400};
  bus::InputStore<models::PlanProposal> proposals_{64};
  bus::InputStore<models::AttackNotice> attacks_{64};
  bus::InputStore<models::TeamProposal> team_proposals_{500};
  /// Logged decisions to compare; the capacity covers bursts of proposals.
  bus::ReplayQueue<std::variant<models::RobotPlan, models::TeamProposal>> logged_{31};
  std::int64_t same_ = 0;
  std::int64_t different_ = 0;
  std::int64_t incomplete_ = 0;
};

/// True if both plans, or proposals, are the same: equal bit for bit except for stamps, computation
/// times and inputs.
bool is_same_decision(const models::RobotPlan& a, const models::RobotPlan& b);
bool is_same_decision(const models::TeamProposal& a, const models::TeamProposal& b);

}  // namespace vantage::planner
