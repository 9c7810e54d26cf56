#include "planner/app/exchanging_mode.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/deadline.hpp"

namespace vantage::planner {
namespace {

// Period of a local search, and its work per period. Messages are handled between the periods.
constexpr Duration kPeriod{5'000};
constexpr std::int64_t kWork_ns = 3'000'000;
constexpr std::int64_t kCalls = 5'000;

}  // namespace

void ExchangingMode::subscribe_to_teammate(const std::string& name) {
  state().subscribe(bus::team_proposal_channel(name), name,
                    [this](const models::TeamProposal& proposal) { take(proposal); });
}

Time ExchangingMode::next_tick() const { return std::min(PlanMode::next_tick(), next_work_); }

SlotStage ExchangingMode::advance(Time now) {
  const SlotStage stage = PlanMode::advance(now);
  next_work_ = Time::max();
  if (stage == SlotStage::kWaiting && exchange_ && now < exchange_end_) {
    improve(now);
  }
  return stage;
}

void ExchangingMode::propose(Time now) {
  NodeState& node = state();
  const RoundSchedule::Slot& slot = node.inputs.slot;
  node.inputs.solution.reset();
  // The candidate search gets a third of the time, the local search the remaining time.
  Deadline deadline = Deadline::nodes(node.node_budget());
  if (node.clock.is_real_time()) {
    const Duration left = std::max(slot.begin + (slot.end - slot.begin) / 3 - now, Duration{0});
    deadline = Deadline::either(deadline.budget_nodes(), monotonic_ns() + left.count() * 1'000);
  }
  exchange_ = node.planner.begin_exchange(node.inputs, deadline);
  if (!exchange_) {
    return;
  }
  inputs_ = names_of(node.inputs, node.robot);
  for (const auto& [teammate, proposal] : newest_proposals_) {
    take(proposal);
  }
  exchange_end_ = node.work_end();  // leaves time for the last proposals to arrive
  next_work_ = now + kPeriod;
}

void ExchangingMode::take(const models::TeamProposal& proposal) {
  newest_proposals_.insert_or_assign(proposal.robot, proposal);
  if (!exchange_) {
    return;
  }
  const ReceiveOutcome outcome = exchange_->receive(proposal);
  state().proposals_refused += outcome == ReceiveOutcome::kRefused ? 1 : 0;
  if (outcome == ReceiveOutcome::kTaken) {
    state().inputs.solution = proposal;
  }
}

void ExchangingMode::improve(Time now) {
  NodeState& node = state();
  next_work_ = now + kPeriod;
  const Deadline deadline = node.clock.is_real_time() && node.spec.node_budget == 0
                                ? Deadline::at(monotonic_ns() + kWork_ns)
                                : Deadline::nodes(kCalls);
  std::optional<models::TeamProposal> proposal = exchange_->improve(deadline);
  if (proposal) {
    std::optional<models::TeamProposal>& solution = node.inputs.solution;
    proposal->inputs = inputs_;
    if (solution) {
      proposal->inputs.push_back(
          models::ref_to(bus::team_proposal_channel(solution->robot).name, solution->stamp));
    }
    solution = node.bus.publish(bus::team_proposal_channel(node.robot), *std::move(proposal));
  }
}

}  // namespace vantage::planner
