#include "planner/app/node.hpp"

#include <algorithm>
#include <utility>

#include "core/index.hpp"
#include "models/exchange/attack_timeout.hpp"
#include "models/exchange/counts.hpp"
#include "planner/app/pose_fill.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::planner {
namespace {

// Maximum wait for a processor within one second, s; twice the wait at which a driver holds its
// vehicle. Longer waits repeatedly cut the search short, and the drivers need the processor time.
constexpr double kProcessorWaitMaxS = 0.2;

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

}  // namespace

PlannerNode::PlannerNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                         const std::string& robot)
    : PlannerNode(bus, clock, std::make_shared<Workspace>(scenario), robot) {}

PlannerNode::PlannerNode(bus::Bus& bus, const bus::Clock& clock,
                         std::shared_ptr<Workspace> workspace, const std::string& robot)
    : workspace_(std::move(workspace)),
      state_{bus, clock, robot, workspace_->scenario().planner, RobotPlanner(workspace_, robot)},
      schedule_(state_.spec, state_.planner.robot_index(), state_.planner.robot_count()),
      mode_(make_plan_mode(state_)) {
  state_.inputs.slot = schedule_.next_slot(end_of_startup_wait(clock, schedule_));
  if (clock.is_real_time()) {
    state_.planner.prefault();
  }
  subscribe_to_own();
  subscribe_to_poses();
  neighbours_.emplace(
      workspace_->scenario(), robot,
      [this](const std::string& name) { subscribe_to_teammate(name); },
      [this](const std::string& name) { unsubscribe_from_teammate(name); });
}

void PlannerNode::subscribe_to_own() {
  const std::string& robot = state_.robot;
  PlanInputs& inputs = state_.inputs;
  state_.subscribe(bus::mixture_channel(robot), robot, [this](const auto& m) { mixture_ = m; });
  state_.subscribe(bus::belief_channel(robot), robot, [this, &inputs](const auto& m) {
    inputs.belief = m;
    inputs.mixture = mixture_ && is_of_belief(*mixture_, m) ? mixture_ : std::nullopt;
  });
  if (state_.spec.objective == scenario::PlanObjective::kMapping) {
    state_.subscribe(bus::map_channel(robot), robot, [&inputs](const auto& m) { inputs.map = m; });
  }
  state_.bus.subscribe_shared<models::MocapFrame>(bus::kVicon,
                                                  [this](const auto& /*name*/, const auto& m) {
                                                    take_frame(m);
                                                    neighbours_->on_frame(*m);
                                                  });
  state_.bus.subscribe<models::AttackNotice>(bus::kAttack, [this, &inputs](const auto& m) {
    inputs.attack = m;
    attack_received_ = state_.clock.now();
  });
  subscribe_to_status(robot);
}

void PlannerNode::subscribe_to_poses() {
  const auto localizer = scenario::localizer_of(workspace_->scenario());
  if (!localizer) {
    return;
  }
  for (const scenario::LocalizedRobotSpec& robot : localizer->robots) {
    state_.subscribe(bus::pose_channel(robot.name), robot.name,
                     [this](const models::PoseEstimate& estimate) {
                       if (!estimate.increments.empty()) {
                         poses_.insert_or_assign(estimate.robot, estimate);
                       }
                     });
  }
}

void PlannerNode::subscribe_to_status(const std::string& name) {
  state_.subscribe(bus::vehicle_channel(name), name, [this, name](const auto& m) {
    state_.inputs.team_statuses.insert_or_assign(name, m);
  });
}

void PlannerNode::subscribe_to_teammate(const std::string& name) {
  subscribe_to_status(name);
  mode_->subscribe_to_teammate(name);
  state_.subscribe(bus::plan_channel(name), name, [this](const auto& m) { take_plan(m); });
}

void PlannerNode::unsubscribe_from_teammate(const std::string& name) {
  state_.bus.unsubscribe(bus::vehicle_channel(name).name);
  state_.bus.unsubscribe(bus::plan_channel(name).name);
  state_.inputs.team_statuses.erase(name);
  state_.inputs.team_plans.erase(name);
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
  PlanInputs& inputs = state_.inputs;
  inputs.mocap = *mocap_;
  inputs.poses.clear();
  for (const auto& [robot, estimate] : poses_) {
    if (show_robot(workspace_->scenario(), estimate, *inputs.mocap)) {
      inputs.poses.insert_or_assign(robot, estimate);
    }
  }
  inputs.mocap_before.reset();
  if (mocap_before_ &&
      shows_bodies_in_the_way(*workspace_, index(state_.planner.robot_index()), *mocap_)) {
    inputs.mocap_before = *mocap_before_;
  }
}

void PlannerNode::take_plan(const models::RobotPlan& plan) {
  const scenario::PlannerSpec& spec = state_.spec;
  const double ahead_s = to_seconds(plan.trajectory.start_time - state_.clock.now());
  if (is_of_plan_length(plan.trajectory, spec, workspace_->scenario().robots) &&
      ahead_s <= kPlanHorizonsMax * spec.horizon_steps * spec.step_s) {
    state_.inputs.team_plans.insert_or_assign(plan.robot, plan);
  } else {
    ++unusable_plans_;
  }
}

void PlannerNode::tick(Time now) {
  PlanInputs& inputs = state_.inputs;
  if (now >= inputs.slot.begin) {
    use_frames();
  }
  switch (mode_->advance(now)) {
    case SlotStage::kWaiting:
      return;
    case SlotStage::kMissed:
      ++slots_skipped_;
      ++state_.plans_late;
      move_on(now);
      return;
    case SlotStage::kDue:
      break;
  }
  if (now - attack_received_ > models::kAttackTimeout) {
    inputs.attack.reset();
  }
  if (inputs.slot.is_proposal) {
    mode_->propose(now);
  } else {
    plan(now);
  }
  move_on(std::max(now, inputs.slot.begin));
}

void PlannerNode::move_on(Time after) {
  RoundSchedule::Slot& slot = state_.inputs.slot;
  const std::optional<int> slot_index = state_.planner.next_slot_index(state_.inputs);
  slot = slot_index ? schedule_.slot_after(slot.round, after, *slot_index)
                    : schedule_.next_slot(after);
}

// A robot without a driver is simulated: a busy machine delays the trial but is not dangerous.
bool PlannerNode::is_short_of_processor() const {
  const std::vector<scenario::RobotSpec>& robots = workspace_->scenario().robots;
  const scenario::RobotSpec& robot = robots[index(state_.planner.robot_index())];
  return robot.device != scenario::DeviceSource::kDirect && processor_wait_s_ > kProcessorWaitMaxS;
}

void PlannerNode::plan(Time now) {
  PlanInputs& inputs = state_.inputs;
  RobotPlanner& planner = state_.planner;
  const bool stops = is_short_of_processor();
  short_of_processor_ += stops ? 1 : 0;
  std::optional<models::RobotPlan> plan =
      stops ? planner.plan_to_stop(inputs) : planner.plan(inputs, state_.deadline(now));
  const Time finish = state_.finish();
  const bool late = finish > inputs.slot.end;
  if (late) {
    // Teammates already plan with the old motion, so no new motion may be published now.
    ++state_.plans_late;
    plan = planner.plan_without_search(inputs);
  }
  if (plan) {
    plan->finish = finish;
    plan->late = late || stops;
    plan->inputs = names_of(inputs, state_.robot);
    inputs.own_plan = state_.bus.publish(bus::plan_channel(state_.robot), *std::move(plan));
  }
}

std::vector<models::NamedCount> PlannerNode::counters() const {
  const PlannerCounts& counts = state_.planner.counts();
  std::vector<models::NamedCount> all{{"plans_late", state_.plans_late},
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
                                      {"misaddressed", state_.misaddressed},
                                      {"unusable_beliefs", counts.unusable_beliefs},
                                      {"unusable_maps", counts.unusable_maps},
                                      {"unusable_plans", unusable_plans_},
                                      {"proposals_refused", state_.proposals_refused},
                                      {"external_rounds", state_.answers},
                                      {"external_missing", state_.answers_missing},
                                      {"external_late", state_.answers_late},
                                      {"external_unasked", state_.answers_unasked},
                                      {"external_refused", counts.answers_refused}};
  models::append_nonzero(all, {{"bodies_dropped", counts.bodies_dropped}});
  if (schedule_.is_shared()) {
    all.push_back({"yielded_rounds", counts.yielded_rounds});
  }
  return all;
}

}  // namespace vantage::planner
