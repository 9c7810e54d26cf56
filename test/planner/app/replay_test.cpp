#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/external_channels.hpp"
#include "models/mapping/cell_counts.hpp"
#include "planner/app/replay_node.hpp"
#include "test/planner/app/node_fixture.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::planner {
namespace {

using vantage::test::sent_ref;

/// A replay of Q1 that receives all messages from and to a planner of Q1.
class ReplayTest : public test::PlannerNodeTest {
 protected:
  void start_replay() {
    replay_ = std::make_unique<PlannerReplayNode>(replay_bus_, clock_, scenario_, "Q1");
    world_.subscribe<models::RobotPlan>(
        {"REPLAY_PLAN_Q1"}, [this](const auto& plan) { replayed_plans_.push_back(plan); });
    world_.subscribe<models::TeamProposal>(
        {"REPLAY_TEAM_PROPOSAL_Q1"},
        [this](const auto& proposal) { replayed_proposals_.push_back(proposal); });
    world_.subscribe<models::TeamProposal>(
        bus::team_proposal_channel("Q1"),
        [this](const auto& proposal) { proposals_.push_back(proposal); });
  }

  void start_both(const scenario::Scenario& scenario) {
    scenario_ = scenario;
    start_replay();  // receives all messages from the start
    start(scenario);
  }

  /// Starts the replay without a planner: the test publishes the logged messages.
  void start_without_planner(const scenario::Scenario& scenario) {
    scenario_ = scenario;
    inputs_ = test::first_inputs(scenario, 0, 5);
    inputs_.belief->robot = "Q1";
    clock_.set(inputs_.slot.begin);
    start_replay();
  }

  void tick() {
    while (replay_bus_.handle(std::chrono::microseconds(0)) > 0) {
    }
    replay_->tick(clock_.now());
    deliver();
  }

  [[nodiscard]] std::int64_t replayed(const std::string& name) const {
    for (const models::NamedCount& counter : replay_->counters()) {
      if (counter.name == name) {
        return counter.count;
      }
    }
    return -1;
  }

  // Expects the given numbers of decisions that were equal, were different, or lacked inputs.
  void expect_counts(std::int64_t same, std::int64_t different, std::int64_t missing) const {
    EXPECT_EQ(replayed("replayed_same"), same);
    EXPECT_EQ(replayed("replayed_different"), different);
    EXPECT_EQ(replayed("replay_inputs_missing"), missing);
  }

  /// Logs a plan of Q1 that names `inputs` as its inputs.
  void log_plan(std::vector<models::InputRef> inputs) {
    models::RobotPlan plan = plan_of("Q1");
    plan.inputs = std::move(inputs);
    world_.publish(bus::plan_channel("Q1"), plan);
  }

  /// Runs `count` rounds of the planner and calls `publish_inputs` before each round.
  void rounds(int count, const std::function<void()>& publish_inputs) {
    for (int k = 0; k < count; ++k) {
      publish_inputs();
      round();
      inputs_.slot.activation += from_seconds(1.0);
      ++inputs_.slot.round;
    }
  }

  void expect_all_again(std::size_t plans, const std::vector<std::string>& channels) {
    tick();
    EXPECT_EQ(plans_.size(), plans);
    expect_counts(static_cast<std::int64_t>(plans_.size() + proposals_.size()), 0, 0);
    ASSERT_EQ(replayed_plans_.size(), plans_.size());
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      EXPECT_TRUE(is_same_decision(replayed_plans_[i], plans_[i]));
      EXPECT_EQ(replayed_plans_[i].finish, plans_[i].finish);
      EXPECT_EQ(replayed_plans_[i].late, plans_[i].late);
      EXPECT_EQ(replayed_plans_[i].inputs, plans_[i].inputs);
    }
    for (const std::string& channel : channels) {
      const auto is_named = [&](const models::InputRef& input) { return input.channel == channel; };
      EXPECT_TRUE(std::any_of(plans_.back().inputs.begin(), plans_.back().inputs.end(), is_named))
          << channel;
    }
  }

  std::unique_ptr<bus::Transport> replay_end_ = hub_.connect();
  bus::Bus replay_bus_{*replay_end_, 3, "REPLAY_"};
  std::unique_ptr<PlannerReplayNode> replay_;
  std::vector<models::RobotPlan> replayed_plans_;
  std::vector<models::TeamProposal> proposals_;
  std::vector<models::TeamProposal> replayed_proposals_;
};

TEST_F(ReplayTest, ReproducesPlansFromTheirInputs) {
  start_both(test::lab_scenario());
  rounds(3, [&] {
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    world_.publish(bus::plan_channel("Q2"), plan_of("Q2"));
    models::VehicleStatus status;
    status.robot = "Q2";
    status.stamp.time = inputs_.slot.begin;
    world_.publish(bus::vehicle_channel("Q2"), status);
    world_.publish(bus::kAttack, models::AttackNotice{inputs_.mocap->stamp, {"Q2"}});
  });
  EXPECT_EQ(replay_->name(), "REPLAY_PLANNER_Q1");
  expect_all_again(3, {"BELIEF_Q1", "PLAN_Q1", "PLAN_Q2", "VEHICLE_Q2", "VICON", "ATTACK"});
}

// A person walks at flight height. The plan names both frames from which it computes the person's
// velocity.
TEST_F(ReplayTest, ReplaysPlanWithPersonFromTwoFrames) {
  start_both(test::lab_scenario());
  rounds(3, [&] {
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    for (int i = 0; i < 3; ++i) {
      models::MocapFrame frame = *inputs_.mocap;
      frame.stamp.time = inputs_.slot.activation - from_seconds(0.6 - 0.12 * i);
      models::MocapBody& person = frame.bodies.emplace_back();
      person.name = "PERSON";
      person.world_from_body.translation_m = {-1.5 - 0.1 * i, 0.2, 1.0};
      world_.publish(bus::kVicon, frame);
    }
  });
  expect_all_again(3, {"BELIEF_Q1", "VICON"});
  for (const models::RobotPlan& plan : plans_) {
    EXPECT_EQ(std::count_if(plan.inputs.begin(), plan.inputs.end(),
                            [](const models::InputRef& input) { return input.channel == "VICON"; }),
              2);
  }
}

TEST_F(ReplayTest, ReproducesStopsOfABusyHost) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[0].device = scenario::DeviceSource::kWire;
  start_both(scenario);
  rounds(4, [&, round = 0]() mutable {
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    node_->on_processor_wait(round++ % 2 == 0 ? 0.0 : 0.3);
  });
  expect_all_again(4, {"BELIEF_Q1", "PLAN_Q1", "VICON"});
  EXPECT_FALSE(replayed_plans_[2].late);
  EXPECT_TRUE(replayed_plans_[3].late);
}

TEST_F(ReplayTest, ReplaysPlanWithProposals) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  start_both(scenario);
  rounds(2, [&] {
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    world_.publish(bus::proposal_channel("Q2"),
                   models::PlanProposal{{inputs_.slot.activation, 0, 0}, 100.0, plan_of("Q2")});
  });
  expect_all_again(2, {"BELIEF_Q1", "PROPOSAL_Q1", "PROPOSAL_Q2"});
}

TEST_F(ReplayTest, ReproducesPlansThatUseMixtures) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.samples = true;
  start_both(scenario);
  rounds(1, [&] {
    models::BeliefMixture mixture;
    mixture.stamp = inputs_.belief->stamp;
    mixture.robot = "Q1";
    const models::Gaussian there{Eigen::Vector2d(1.0, 1.0), Eigen::Matrix2d::Identity()};
    mixture.targets.push_back({0, 1.0, {{0.5, there}, {0.5, there}}});
    world_.publish(bus::mixture_channel("Q1"), mixture);
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  });
  expect_all_again(1, {"MIXTURE_Q1"});
}

TEST_F(ReplayTest, ReproducesPlansThatUseMaps) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.targets.clear();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.planner.horizon_steps = 2;
  start_both(scenario);
  rounds(1, [&] {
    models::RobotMap map;
    map.robot = "Q1";
    map.grid = models::map_geometry(scenario_.world, scenario_.mapping);
    map.own_looks.assign(static_cast<std::size_t>(map.grid.size()), 0);
    map.team_looks = map.own_looks;
    world_.publish(bus::map_channel("Q1"), map);
  });
  EXPECT_EQ(count("unusable_maps"), 0);
  expect_all_again(1, {"MAP_Q1"});
}

TEST_F(ReplayTest, ReproducesExternalPlans) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.algorithm = "external";
  start_both(scenario);
  world_.subscribe<models::RobotPlan>(bus::external_request_channel("Q1"),
                                      [&](const models::RobotPlan& question) {
                                        models::RobotPlan answer = question;
                                        answer.trajectory.segments = {{{0.5, 0.0}, 1.0, 0.0}};
                                        world_.publish(bus::external_plan_channel("Q1"), answer);
                                      });
  rounds(2, [&] { world_.publish(bus::belief_channel("Q1"), *inputs_.belief); });
  EXPECT_EQ(plans_.front().source, models::PlanSource::kSearched);
  expect_all_again(2, {"EXTERNAL_PLAN_Q1"});
}

// The replay repeats the robot's own proposals and the resulting plan. The robot's first proposal
// improves on a proposal of a teammate.
TEST_F(ReplayTest, ReplaysTheRobotsProposals) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kLocalSearch;
  scenario.planner.candidates_max = 20;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.sensor.range_max_m = 3.0;
  }
  start_both(scenario);
  RobotPlanner mate(scenario, "Q2");
  const auto of_mate = mate.begin_exchange(test::first_inputs(scenario, 1, 5),
                                           Deadline::nodes(scenario.planner.node_budget));
  ASSERT_TRUE(of_mate);
  const auto proposed = of_mate->improve(Deadline::never());
  ASSERT_TRUE(proposed);
  rounds(1, [&] {
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    world_.publish(bus::team_proposal_channel("Q2"), *proposed);
  });
  ASSERT_FALSE(proposals_.empty());
  EXPECT_EQ(proposals_[0].inputs.back(), (models::InputRef{"TEAM_PROPOSAL_Q2", 100, 0}));
  EXPECT_EQ(proposals_[0].choices.size(), 2U);
  expect_all_again(1, {"TEAM_PROPOSAL_Q1"});
  ASSERT_EQ(replayed_proposals_.size(), proposals_.size());
  for (std::size_t i = 0; i < proposals_.size(); ++i) {
    EXPECT_TRUE(is_same_decision(replayed_proposals_[i], proposals_[i]));
    EXPECT_EQ(replayed_proposals_[i].nodes, proposals_[i].nodes);
    EXPECT_EQ(replayed_proposals_[i].inputs, proposals_[i].inputs);
  }
  // The replay must report a difference from a logged proposal with a changed value, another input
  // proposal, another round, or no inputs.
  models::TeamProposal other = proposals_.back();
  other.value_nats += 1.0;
  robot_bus_.publish(bus::team_proposal_channel("Q1"), other);
  models::TeamProposal of_last = proposals_.back();
  of_last.inputs.back() = {"TEAM_PROPOSAL_Q1", 1, static_cast<std::int64_t>(proposals_.size()) - 1};
  robot_bus_.publish(bus::team_proposal_channel("Q1"), of_last);
  models::TeamProposal later = proposals_.back();
  ++later.round;
  robot_bus_.publish(bus::team_proposal_channel("Q1"), later);
  models::TeamProposal of_nothing = proposals_.back();
  of_nothing.inputs.clear();
  robot_bus_.publish(bus::team_proposal_channel("Q1"), of_nothing);
  deliver();
  const std::int64_t same = replayed("replayed_same");
  tick();
  expect_counts(same, 4, 0);
}

TEST_F(ReplayTest, ReportsDifferentPlans) {
  start_both(test::lab_scenario());
  rounds(1, [&] { world_.publish(bus::belief_channel("Q1"), *inputs_.belief); });
  expect_all_again(1, {"BELIEF_Q1"});
  models::RobotPlan other = plans_.at(0);
  other.cost += 1.0;
  robot_bus_.publish(bus::plan_channel("Q1"), other);
  deliver();
  tick();
  expect_counts(1, 1, 0);
  models::RobotPlan of_nothing = plans_.at(0);
  of_nothing.inputs.clear();
  robot_bus_.publish(bus::plan_channel("Q1"), of_nothing);
  deliver();
  tick();
  expect_counts(1, 2, 0);  // no plan is made without a pose
  models::RobotPlan of_another = plans_.at(0);
  of_another.robot = "Q2";
  robot_bus_.publish(bus::plan_channel("Q1"), of_another);
  deliver();
  tick();
  expect_counts(1, 2, 0);  // a different robot's proposal
}

// After a search that ended too late, the robot continues its committed motion.
TEST_F(ReplayTest, ReproducesFallbacksOfLateSearches) {
  start_without_planner(test::lab_scenario());
  const auto belief = sent_ref(world_, bus::belief_channel("Q1"), *inputs_.belief);
  const auto mocap = sent_ref(world_, bus::kVicon, *inputs_.mocap);
  RobotPlanner planner(scenario_, "Q1");
  models::RobotPlan shifted = *planner.plan_without_search(inputs_);
  shifted.inputs = {belief, mocap};
  shifted.nodes = 1'500;
  shifted.late = true;
  shifted.finish = inputs_.slot.end + Duration{7};
  world_.publish(bus::plan_channel("Q1"), shifted);
  shifted.late = false;
  world_.publish(bus::plan_channel("Q1"), shifted);
  deliver();
  tick();
  expect_counts(1, 1, 0);
  ASSERT_EQ(replayed_plans_.size(), 2U);
  EXPECT_EQ(replayed_plans_[0].source, models::PlanSource::kShifted);
  EXPECT_TRUE(replayed_plans_[0].late);
  EXPECT_EQ(replayed_plans_[0].finish, shifted.finish);
  EXPECT_NE(replayed_plans_[1].source, models::PlanSource::kShifted);
}

// With shared slots, each plan states the slot in which it was made.
TEST_F(ReplayTest, PlansInTheLoggedSlot) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.slots = 2;
  start_without_planner(scenario);
  const auto mocap = sent_ref(world_, bus::kVicon, *inputs_.mocap);
  const RoundSchedule schedule(scenario.planner, 0, 3);
  std::vector<Time> begins;
  for (const int place : {1, 0}) {
    const RoundSchedule::Slot slot = schedule.slot(inputs_.slot.round, place);
    models::RobotPlan plan = plan_of("Q1");
    plan.slot_start = slot.begin;
    plan.inputs = {mocap};
    world_.publish(bus::plan_channel("Q1"), plan);
    begins.push_back(slot.begin);
  }
  deliver();
  tick();
  ASSERT_EQ(replayed_plans_.size(), 2U);
  EXPECT_EQ(replayed_plans_[0].slot_start, begins[0]);
  EXPECT_EQ(replayed_plans_[1].slot_start, begins[1]);
}

// Inputs may be logged after the message that was computed from them. The replay waits two seconds
// for missing inputs and then continues with the next message.
TEST_F(ReplayTest, WaitsForMissingInputs) {
  start_without_planner(test::lab_scenario());
  EXPECT_EQ(replay_->next_tick(), clock_.now());
  log_plan({{"BELIEF_Q1", 100, 0}});
  log_plan({{"BELIEF_Q1", 100, 1}});
  deliver();
  const auto tick_later = [&] {
    clock_.set(clock_.now() + Duration{100'000});
    tick();
    EXPECT_EQ(replay_->next_tick(), clock_.now() + Duration{100'000});
  };
  tick_later();
  expect_counts(0, 0, 0);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  tick_later();
  expect_counts(0, 1, 0);  // inputs are found, but a plan also needs a pose
  for (int k = 0; k < 30; ++k) {
    tick_later();
  }
  expect_counts(0, 1, 1);
  log_plan({{"BELIEF_Q1", 100, 0}});
  deliver();
  tick_later();
  expect_counts(0, 2, 1);
}

// Up to 30 messages may wait behind a message with missing inputs.
TEST_F(ReplayTest, SkipsMessageWithMissingInputsWhen31OthersWait) {
  start_without_planner(test::lab_scenario());
  log_plan({{"BELIEF_Q1", 100, 0}});
  for (int k = 0; k < 30; ++k) {
    log_plan({});
  }
  deliver();
  tick();
  expect_counts(0, 0, 0);
  log_plan({});
  deliver();
  tick();
  expect_counts(0, 31, 1);
}

// The replay keeps a limited number of messages per channel. It finds the oldest of these as an
// input, but not the message before.
TEST_F(ReplayTest, KeepsLimitedMessagesPerChannel) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.targets.clear();
  start_without_planner(scenario);
  std::int64_t logged = 0;
  const auto expect_kept = [&](const std::string& channel, int count, const auto& publish_once) {
    SCOPED_TRACE(channel);
    const auto publish_times = [&](int times) {
      for (int k = 0; k < times; ++k) {
        publish_once();
      }
      deliver();
    };
    publish_times(count);
    for (int k = 0; k <= 1; ++k) {
      log_plan({{channel, 100, 0}});
      for (int i = 0; i < 25; ++i) {
        tick();
      }
      publish_times(1);
    }
    ++logged;
    expect_counts(0, logged, logged);
  };
  expect_kept("BELIEF_Q1", 64, [&] { world_.publish(bus::belief_channel("Q1"), *inputs_.belief); });
  models::BeliefMixture mixture;
  mixture.robot = "Q1";
  expect_kept("MIXTURE_Q1", 64, [&] { world_.publish(bus::mixture_channel("Q1"), mixture); });
  models::RobotMap map;
  map.robot = "Q1";
  map.grid = {{-4.0, -2.0}, 1.0, 8, 4};
  map.own_looks.assign(32, 0);
  map.team_looks = map.own_looks;
  expect_kept("MAP_Q1", 64, [&] { world_.publish(bus::map_channel("Q1"), map); });
  models::MocapFrame nobody;
  expect_kept("VICON", 4'000, [&] { world_.publish(bus::kVicon, nobody); });
  expect_kept("EXTERNAL_PLAN_Q1", 64,
              [&] { world_.publish(bus::external_plan_channel("Q1"), plan_of("Q1")); });
  models::VehicleStatus status;
  status.robot = "Q2";
  expect_kept("VEHICLE_Q2", 400, [&] { world_.publish(bus::vehicle_channel("Q2"), status); });
  expect_kept("PROPOSAL_Q2", 64, [&] {
    world_.publish(bus::proposal_channel("Q2"), models::PlanProposal{{}, 1.0, plan_of("Q2")});
  });
  expect_kept("ATTACK", 64, [&] { world_.publish(bus::kAttack, models::AttackNotice{}); });
  models::TeamProposal proposal;
  proposal.robot = "Q2";
  proposal.value_nats = 1.0;
  proposal.history = {1};
  expect_kept("TEAM_PROPOSAL_Q2", 500,
              [&] { world_.publish(bus::team_proposal_channel("Q2"), proposal); });
  // The logged plans of Q1 have their own channel, so they do not displace messages of Q2.
  expect_kept("PLAN_Q2", 64, [&] { world_.publish(bus::plan_channel("Q2"), plan_of("Q2")); });
}

}  // namespace
}  // namespace vantage::planner
