#include "planner/app/proposing_mode.hpp"

#include <optional>
#include <utility>

namespace vantage::planner {

void ProposingMode::subscribe_to_teammate(const std::string& name) {
  state().subscribe(bus::proposal_channel(name), name,
                    [&inputs = state().inputs, name](const models::PlanProposal& proposal) {
                      inputs.proposals.insert_or_assign(name, proposal);
                    });
}

void ProposingMode::propose(Time now) {
  NodeState& node = state();
  std::optional<models::PlanProposal> proposal =
      node.planner.propose(node.inputs, node.deadline(now));
  const Time finish = node.finish();
  if (finish > node.inputs.slot.end) {
    ++node.plans_late;  // the other robots choose the bait without this proposal
    return;
  }
  if (proposal) {
    proposal->plan.finish = finish;
    proposal->plan.inputs = names_of(node.inputs, node.robot);
    node.inputs.proposals.insert_or_assign(
        node.robot, node.bus.publish(bus::proposal_channel(node.robot), *std::move(proposal)));
  }
}

}  // namespace vantage::planner
