#include "planner/app/node.hpp"

#include <algorithm>
#include <utility>

#include "bus/convert/external_channels.hpp"
#include "core/deadline.hpp"
#include "models/exchange/attack_timeout.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "scenario/node_budget.hpp"
#include "scenario/search_name.hpp"

namespace vantage::planner {
namespace {

// Time reserved at the end of a slot. The plan must be complete, checked and sent before the slot
// ends, despite scheduler stalls (8 ms is usual on a virtual machine, 24 ms under load).
constexpr Duration kClosing{20'000};

// Maximum processor wait within one second, s: twice the wait at which a driver holds its vehicle.
// A search that waits longer is cut short repeatedly, and drivers need the processor time.
constexpr double kProcessorWaitMaxS = 0.2;

Duration closing_of(const RoundSchedule::Slot& slot) {
  return std::min(kClosing, (slot.end - slot.begin) / 5);
}

// Time for which a planner only receives after a restart. It first needs its vehicle's status,
// published at 10 Hz, and a plan of every teammate; a teammate without a plan is assumed to hover.
// All teammates have a slot in the round before the planner's own.
constexpr Duration kStartupWait{350'000};

Time end_of_startup_wait(const bus::Clock& clock, const RoundSchedule& schedule) {
  const Time now = clock.now();
  return clock.is_real_time() ? now + kStartupWait + schedule.round_length() : now;
}

// The velocity of a body other than a robot is computed over one to two times this interval.
constexpr Duration kVelocityTime{100'000};

// Period of a local search's work, and its work per period; messages are handled between the
// periods.
constexpr Duration kExchangePeriod{5'000};
constexpr std::int64_t kExchangeWork_ns = 3'000'000;
constexpr std::int64_t kExchangeCalls = 5'000;

template <class Message>
const std::string& robot_of(const Message& message) {
  return message.robot;
}
const std::string& robot_of(const models::PlanProposal& proposal) { return proposal.plan.robot; }

}  // namespace

PlannerNode::PlannerNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                         const std::string& robot)
    : PlannerNode(bus, clock, std::make_shared<Workspace>(scenario), robot) {}

PlannerNode::PlannerNode(bus::Bus& bus, const bus::Clock& clock,
                         std::shared_ptr<Workspace> workspace, const std::string& robot)
    : bus_(bus),
      clock_(clock),
      workspace_(std::move(workspace)),
      spec_(workspace_->scenario().planner),
      robots_(workspace_->scenario().robots),
      robot_(robot),
      planner_(workspace_, robot),
      schedule_(spec_, planner_.robot_index(), planner_.robot_count()),
      slot_(schedule_.next_slot(end_of_startup_wait(clock, schedule_))) {
  if (clock.is_real_time()) {
    planner_.prefault();
  }
  subscribe_to<models::BeliefMixture>(bus::mixture_channel(robot), robot,
                                      [this](const auto& m) { mixture_ = m; });
  subscribe_to<models::RobotBelief>(bus::belief_channel(robot), robot, [this](const auto& m) {
    inputs_.belief = m;
    inputs_.mixture = mixture_ && is_of_belief(*mixture_, m) ? mixture_ : std::nullopt;
  });
  if (spec_.objective == scenario::PlanObjective::kMapping) {
    subscribe_to<models::RobotMap>(bus::map_channel(robot), robot,
                                   [this](const auto& m) { inputs_.map = m; });
  }
  if (scenario::is_external(spec_)) {
    subscribe_to<models::RobotPlan>(bus::external_plan_channel(robot), robot,
                                    [this](const auto& m) { take_answer(m); });
  }
  bus_.subscribe_shared<models::MocapFrame>(bus::kVicon,
                                            [this](const auto& /*name*/, const auto& m) {
                                              take_frame(m);
                                              neighbours_->on_frame(*m);
                                            });
  bus_.subscribe<models::AttackNotice>(bus::kAttack, [this](const auto& m) {
    inputs_.attack = m;
    attack_received_ = clock_.now();
  });
  subscribe_to_status(robot);
  neighbours_.emplace(
      workspace_->scenario(), robot,
      [this](const std::string& name) { subscribe_to_teammate(name); },
      [this](const std::string& name) {
        bus_.unsubscribe(bus::vehicle_channel(name).name);
        bus_.unsubscribe(bus::plan_channel(name).name);
        inputs_.team_statuses.erase(name);
        inputs_.team_plans.erase(name);
      });
}

void PlannerNode::subscribe_to_status(const std::string& name) {
  subscribe_to<models::VehicleStatus>(
      bus::vehicle_channel(name), name,
      [this, name](const auto& m) { inputs_.team_statuses.insert_or_assign(name, m); });
}

void PlannerNode::subscribe_to_teammate(const std::string& name) {
  subscribe_to_status(name);
  if (spec_.team_algorithm.exchanges_solutions()) {
    subscribe_to<models::TeamProposal>(bus::team_proposal_channel(name), name,
                                       [this](const auto& m) { take_proposal(m); });
  }
  if (spec_.attacks_max > 0) {
    subscribe_to<models::PlanProposal>(
        bus::proposal_channel(name), name,
        [this, name](const auto& m) { inputs_.proposals.insert_or_assign(name, m); });
  }
  subscribe_to<models::RobotPlan>(bus::plan_channel(name), name,
                                  [this](const auto& m) { take_plan(m); });
}

template <class Message>
void PlannerNode::subscribe_to(const bus::Channel<Message>& channel, const std::string& robot,
                               std::function<void(const Message&)> take) {
  bus_.subscribe<Message>(channel, [this, robot, take = std::move(take)](const Message& m) {
    if (robot_of(m) == robot) {
      take(m);
    } else {
      ++misaddressed_;
    }
  });
}

void PlannerNode::take_frame(const std::shared_ptr<const models::MocapFrame>& frame) {
  const bool goes_back = mocap_ && frame->stamp.time < mocap_->stamp.time;
  mocap_ = frame;
  if (goes_back) {  // the frame is from another publisher, or a clock was set
    mocap_before_ = mocap_between_ = nullptr;
  }
  if (!mocap_between_ || frame->stamp.time - mocap_between_->stamp.time >= kVelocityTime) {
    mocap_before_ = mocap_between_;
    mocap_between_ = frame;
  }
}

void PlannerNode::use_frames() {
  if (!mocap_) {
    return;
  }
  inputs_.mocap = *mocap_;
  inputs_.mocap_before.reset();
  const auto robot = static_cast<std::size_t>(planner_.robot_index());
  if (mocap_before_ && shows_bodies_in_the_way(*workspace_, robot, *mocap_)) {
    inputs_.mocap_before = *mocap_before_;
  }
}

void PlannerNode::take_plan(const models::RobotPlan& plan) {
  const double ahead_s = to_seconds(plan.trajectory.start_time - clock_.now());
  if (is_of_plan_length(plan.trajectory, spec_, robots_) &&
      ahead_s <= kPlanHorizonsMax * spec_.horizon_steps * spec_.step_s) {
    inputs_.team_plans.insert_or_assign(plan.robot, plan);
  } else {
    ++unusable_plans_;
  }
}

Deadline PlannerNode::deadline_of(Time now) const {
  if (!clock_.is_real_time() || spec_.node_budget > 0) {
    return Deadline::nodes(spec_.node_budget > 0 ? spec_.node_budget
                                                 : scenario::kDefaultNodeBudget);
  }
  const Duration left = std::max(slot_.end - closing_of(slot_) - now, Duration{0});
  return Deadline::at(monotonic_ns() + left.count() * 1'000);
}

std::vector<models::InputRef> names_of(const PlanInputs& inputs, const std::string& robot) {
  std::vector<models::InputRef> names;
  const auto add = [&](const std::string& channel, const models::Stamp& stamp) {
    names.push_back(models::ref_to(channel, stamp));
  };
  if (inputs.belief) {
    add(bus::belief_channel(robot).name, inputs.belief->stamp);
  }
  if (inputs.mixture) {
    add(bus::mixture_channel(robot).name, inputs.mixture->stamp);
  }
  if (inputs.map) {
    add(bus::map_channel(robot).name, inputs.map->stamp);
  }
  if (inputs.mocap) {
    add(bus::kVicon.name, inputs.mocap->stamp);
  }
  if (inputs.mocap_before) {
    add(bus::kVicon.name, inputs.mocap_before->stamp);
  }
  if (inputs.own_plan) {
    add(bus::plan_channel(robot).name, inputs.own_plan->stamp);
  }
  for (const auto& [teammate, plan] : inputs.team_plans) {
    add(bus::plan_channel(teammate).name, plan.stamp);
  }
  for (const auto& [teammate, status] : inputs.team_statuses) {
    add(bus::vehicle_channel(teammate).name, status.stamp);
  }
  for (const auto& [proposer, proposal] : inputs.proposals) {
    if (proposal.plan.round == inputs.slot.round) {
      add(bus::proposal_channel(proposer).name, proposal.stamp);
    }
  }
  if (inputs.solution && inputs.solution->round == inputs.slot.round) {
    add(bus::team_proposal_channel(inputs.solution->robot).name, inputs.solution->stamp);
  }
  if (inputs.answer && inputs.answer->round == inputs.slot.round) {
    add(bus::external_plan_channel(robot).name, inputs.answer->stamp);
  }
  if (inputs.attack) {
    add(bus::kAttack.name, inputs.attack->stamp);
  }
  return names;
}

void PlannerNode::tick(Time now) {
  if (now < slot_.begin) {
    exchange(now);
    return;
  }
  next_exchange_ = Time::max();
  if (now >= slot_.end && !is_request_pending_) {  // the slot has passed
    ++slots_skipped_;
    ++late_;
    move_on(now);
    return;
  }
  inputs_.slot = slot_;
  if (!is_request_pending_ && scenario::is_external(spec_) && request_plan(now)) {
    return;  // wait for the answer or its deadline
  }
  is_request_pending_ = false;
  use_frames();
  if (now - attack_received_ > models::kAttackTimeout) {
    inputs_.attack.reset();
  }
  if (slot_.is_proposal && spec_.team_algorithm.exchanges_solutions()) {
    begin_exchange(now);
  } else if (slot_.is_proposal) {
    propose(now);
  } else {
    plan(now);
  }
  move_on(std::max(now, slot_.begin));
}

void PlannerNode::move_on(Time after) {
  const std::optional<int> slot_index = planner_.next_slot_index(inputs_);
  slot_ = slot_index ? schedule_.slot_after(slot_.round, after, *slot_index)
                     : schedule_.next_slot(after);
}

void PlannerNode::propose(Time now) {
  std::optional<models::PlanProposal> proposal = planner_.propose(inputs_, deadline_of(now));
  const Time finish = clock_.is_real_time() ? clock_.now() : slot_.end - closing_of(slot_);
  if (finish > slot_.end) {
    ++late_;  // the other robots choose the bait without this proposal
    return;
  }
  if (proposal) {
    proposal->plan.finish = finish;
    proposal->plan.inputs = names_of(inputs_, robot_);
    inputs_.proposals.insert_or_assign(
        robot_, bus_.publish(bus::proposal_channel(robot_), *std::move(proposal)));
  }
}

void PlannerNode::begin_exchange(Time now) {
  inputs_.solution.reset();
  // The candidate search gets a third of the time, the local search the remaining time.
  Deadline deadline =
      Deadline::nodes(spec_.node_budget > 0 ? spec_.node_budget : scenario::kDefaultNodeBudget);
  if (clock_.is_real_time()) {
    const Duration left = std::max(slot_.begin + (slot_.end - slot_.begin) / 3 - now, Duration{0});
    deadline = Deadline::either(deadline.budget_nodes(), monotonic_ns() + left.count() * 1'000);
  }
  exchange_ = planner_.begin_exchange(inputs_, deadline);
  if (!exchange_) {
    return;
  }
  exchange_inputs_ = names_of(inputs_, robot_);
  for (const auto& [teammate, proposal] : newest_proposals_) {
    take_proposal(proposal);
  }
  exchange_end_ = slot_.end - closing_of(slot_);  // leaves time for the last proposals to arrive
  next_exchange_ = now + kExchangePeriod;
}

void PlannerNode::take_proposal(const models::TeamProposal& proposal) {
  newest_proposals_.insert_or_assign(proposal.robot, proposal);
  if (!exchange_) {
    return;
  }
  const ReceiveOutcome outcome = exchange_->receive(proposal);
  proposals_refused_ += outcome == ReceiveOutcome::kRefused ? 1 : 0;
  if (outcome == ReceiveOutcome::kTaken) {
    inputs_.solution = proposal;
  }
}

void PlannerNode::exchange(Time now) {
  next_exchange_ = now + kExchangePeriod;
  if (!exchange_ || now >= exchange_end_) {
    next_exchange_ = Time::max();
    return;
  }
  const Deadline deadline = clock_.is_real_time() && spec_.node_budget == 0
                                ? Deadline::at(monotonic_ns() + kExchangeWork_ns)
                                : Deadline::nodes(kExchangeCalls);
  std::optional<models::TeamProposal> proposal = exchange_->improve(deadline);
  if (proposal) {
    proposal->inputs = exchange_inputs_;
    if (inputs_.solution) {
      proposal->inputs.push_back(models::ref_to(
          bus::team_proposal_channel(inputs_.solution->robot).name, inputs_.solution->stamp));
    }
    inputs_.solution = bus_.publish(bus::team_proposal_channel(robot_), *std::move(proposal));
  }
}

bool PlannerNode::request_plan(Time now) {
  inputs_.answer.reset();
  use_frames();
  std::optional<models::RobotPlan> request = planner_.external_request(inputs_);
  answer_due_ = slot_.end - closing_of(slot_);
  if (!request || now >= answer_due_) {
    return false;
  }
  request->deadline = answer_due_;
  request->finish = now;
  request->inputs = names_of(inputs_, robot_);
  is_request_pending_ = true;  // set first, because the answer may arrive during publish()
  requested_round_ = slot_.round;
  bus_.publish(bus::external_request_channel(robot_), *request);
  return true;
}

void PlannerNode::take_answer(const models::RobotPlan& answer) {
  const bool is_of_slot = answer.round == requested_round_;
  const bool is_first = !inputs_.answer || inputs_.answer->round != answer.round;
  if (is_request_pending_ && is_of_slot && is_first) {
    ++answers_;
    inputs_.answer = answer;
    answer_due_ = clock_.now();
  } else if (answer.round <= requested_round_ && is_first) {
    ++answers_late_;
  } else {
    ++answers_unsolicited_;
  }
}

// A robot without a driver is simulated: a busy machine delays the trial but is not dangerous.
bool PlannerNode::is_short_of_processor() const {
  const scenario::RobotSpec& robot = robots_[static_cast<std::size_t>(planner_.robot_index())];
  return robot.device != scenario::DeviceSource::kDirect && processor_wait_s_ > kProcessorWaitMaxS;
}

void PlannerNode::plan(Time now) {
  if (scenario::is_external(spec_) && requested_round_ == slot_.round && !inputs_.answer) {
    ++answers_missing_;
  }
  const bool stops = is_short_of_processor();
  short_of_processor_ += stops ? 1 : 0;
  std::optional<models::RobotPlan> plan =
      stops ? planner_.plan_to_stop(inputs_) : planner_.plan(inputs_, deadline_of(now));
  const Time finish = clock_.is_real_time() ? clock_.now() : slot_.end - closing_of(slot_);
  const bool late = finish > slot_.end;
  if (late) {
    // Teammates already plan with the old motion, so no new motion may be published now.
    ++late_;
    plan = planner_.plan_without_search(inputs_);
  }
  if (plan) {
    plan->finish = finish;
    plan->late = late || stops;
    plan->inputs = names_of(inputs_, robot_);
    inputs_.own_plan = bus_.publish(bus::plan_channel(robot_), *std::move(plan));
  }
}

std::vector<models::NamedCount> PlannerNode::counters() const {
  const PlannerCounts& counts = planner_.counts();
  std::vector<models::NamedCount> all{{"plans_late", late_},
                                      {"slots_skipped", slots_skipped_},
                                      {"rounds_short_of_processor", short_of_processor_},
                                      {"fallbacks_shifted", counts.fallbacks_shifted},
                                      {"fallbacks_braking", counts.fallbacks_braking},
                                      {"off_plan", counts.off_plan},
                                      {"turns_away", counts.turns_away},
                                      {"bait_rounds", counts.bait_rounds},
                                      {"rest_rounds", counts.rest_rounds},
                                      {"plan_checks_failed", counts.checks_failed},
                                      {"rounds_without_pose", counts.no_pose},
                                      {"rounds_of_unknown_plan", counts.unknown_plan},
                                      {"misaddressed", misaddressed_},
                                      {"unusable_beliefs", counts.unusable_beliefs},
                                      {"unusable_maps", counts.unusable_maps},
                                      {"unusable_plans", unusable_plans_},
                                      {"proposals_refused", proposals_refused_},
                                      {"external_rounds", answers_},
                                      {"external_missing", answers_missing_},
                                      {"external_late", answers_late_},
                                      {"external_unasked", answers_unsolicited_},
                                      {"external_refused", counts.answers_refused}};
  if (counts.bodies_dropped > 0) {
    all.push_back({"bodies_dropped", counts.bodies_dropped});
  }
  if (schedule_.is_shared()) {
    all.push_back({"yielded_rounds", counts.yielded_rounds});
  }
  return all;
}

}  // namespace vantage::planner
