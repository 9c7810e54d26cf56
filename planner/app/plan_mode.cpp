#include "planner/app/plan_mode.hpp"

#include "planner/app/exchanging_mode.hpp"
#include "planner/app/external_mode.hpp"
#include "planner/app/proposing_mode.hpp"
#include "scenario/search_name.hpp"

namespace vantage::planner {
namespace {

/// Mode of a robot that plans without an exchange.
class SoloMode : public PlanMode {
 public:
  explicit SoloMode(NodeState& state) : PlanMode(state) {}
};

}  // namespace

SlotStage PlanMode::advance(Time now) {
  const RoundSchedule::Slot& slot = state_.inputs.slot;
  if (now < slot.begin) {
    return SlotStage::kWaiting;
  }
  return now < slot.end ? SlotStage::kDue : SlotStage::kMissed;
}

std::unique_ptr<PlanMode> make_plan_mode(NodeState& state) {
  if (scenario::is_external(state.spec)) {
    return std::make_unique<ExternalMode>(state);
  }
  if (state.spec.team_algorithm.exchanges_solutions()) {
    return std::make_unique<ExchangingMode>(state);
  }
  if (state.spec.attacks_max > 0) {
    return std::make_unique<ProposingMode>(state);
  }
  return std::make_unique<SoloMode>(state);
}

}  // namespace vantage::planner
