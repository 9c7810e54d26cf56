#include "estimator/app/node.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "estimator/app/replay_node.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::estimator {
namespace {

using namespace std::chrono_literals;
using models::InputRef;
using vantage::test::sent_ref;

const Time kStart = from_utime(1'700'000'000'100'000);  // 0.1 s after a multiple of τ

scenario::Scenario two_robots() {
  scenario::Scenario scenario;
  scenario.world.bounds = {{-6.0, -6.0}, {6.0, 6.0}};
  for (const char* name : {"Q1", "Q2"}) {
    scenario::RobotSpec robot;
    robot.name = name;
    robot.sensor.range_max_m = 5.0;
    scenario.robots.push_back(robot);
  }
  for (int id = 0; id < 3; ++id) {
    scenario.targets.push_back({"T" + std::to_string(id), id, std::nullopt, 0.2});
  }
  scenario.estimator.target_model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
  scenario.planner.step_s = 0.5;
  scenario.network.communication_range_m = 20.0;
  return scenario;
}

models::MocapFrame frame_at(Time time, const std::map<std::string, Pose2>& poses) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.arrival = time;
  for (const auto& [name, pose] : poses) {
    frame.bodies.push_back({name, lift(pose, 1.0), false});
  }
  return frame;
}

std::map<std::string, std::int64_t> counts_of(const EstimatorNode& node) {
  std::map<std::string, std::int64_t> counts;
  for (const models::NamedCount& count : node.counters()) {
    counts[count.name] = count.count;
  }
  return counts;
}

/// An in-process bus with a publisher of sensor and mocap messages and a subscriber to all beliefs.
class NodeTest : public ::testing::Test {
 protected:
  void deliver() {
    while (world_.handle(0us) + robot_bus_.handle(0us) + mate_bus_.handle(0us) +
               replay_bus_.handle(0us) >
           0) {
    }
  }

  /// Moves the clock to `time` and ticks nodes at the times that they request.
  void run_until(Time time, const std::vector<bus::Node*>& nodes) {
    for (bus::Node* node : nodes) {
      while (node->next_tick() <= time) {
        clock_.set(node->next_tick());
        node->tick(clock_.now());
        deliver();
      }
    }
    clock_.set(time);
  }

  models::RobotMeasurement look(const std::string& robot, Time time, const Pose2& pose) {
    models::RobotMeasurement set;
    set.stamp.time = time;
    set.robot = robot;
    set.viewpoint = {pose, 1.0};
    for (int id = 0; id < 3; ++id) {
      const Eigen::Vector2d target_m(-2.0 + 2.0 * id, 1.0);
      if (models::in_view(scenario_.robots[0].sensor, set.viewpoint, target_m)) {
        set.detections.push_back(
            {id, models::sample(scenario_.robots[0].sensor, set.viewpoint, target_m, rng_)});
      }
    }
    return set;
  }

  scenario::Scenario scenario_ = two_robots();
  std::mt19937_64 rng_{12};
  bus::VirtualClock clock_{kStart};
  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> world_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> robot_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> mate_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> replay_end_ = hub_.connect();
  bus::Bus world_{*world_end_, 100};
  bus::Bus robot_bus_{*robot_end_, 1};
  bus::Bus mate_bus_{*mate_end_, 2};
  bus::Bus replay_bus_{*replay_end_, 3, "REPLAY_"};
};

TEST_F(NodeTest, PublishesAtEveryMultipleOfTheStepAndNamesItsInputs) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<models::RobotBelief> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                        [&](const auto& belief) { received.push_back(belief); });
  const Time t1 = kStart + 400ms;
  EXPECT_EQ(node.next_tick(), t1 + 50ms);
  const auto mocap = sent_ref(world_, bus::kVicon, frame_at(t1 - 10ms, {{"Q1", {1.0, 2.0, 0.5}}}));
  world_.publish(bus::kVicon, frame_at(t1 + 10ms, {{"Q1", {9.0, 9.0, 0.5}}}));
  models::RobotBelief mate =
      test::prior(t1 - 500ms, {{Eigen::Vector4d(1.0, 0.0, 0.0, 0.0), Eigen::Matrix4d::Identity()}});
  mate.robot = "Q2";
  const auto news = sent_ref(world_, bus::belief_channel("Q2"), mate);
  deliver();
  run_until(t1 + 60ms, {&node});
  const Pose2 pose{0.0, -1.0, 0.3};
  const auto seen = sent_ref(world_, bus::measurement_channel("Q1"), look("Q1", t1 + 500ms, pose));
  deliver();
  run_until(t1 + 560ms, {&node});

  ASSERT_EQ(received.size(), 2u);
  EXPECT_EQ(received[0].stamp.time, t1);
  EXPECT_EQ(received[0].step, 0);
  EXPECT_EQ(received[0].inputs, (std::vector<InputRef>{mocap, news}));
  EXPECT_NEAR(received[0].viewpoint.world_from_body.x_m, 1.0, 1e-9);
  EXPECT_NEAR(received[0].viewpoint.height_m, 1.0, 1e-9);
  ASSERT_EQ(received[0].targets.size(), 1u);
  EXPECT_EQ(received[1].stamp.time, t1 + 500ms);
  EXPECT_EQ(received[1].step, 1);
  EXPECT_EQ(received[1].inputs, (std::vector<InputRef>{seen, news}));
  EXPECT_EQ(received[1].viewpoint.world_from_body, pose);
  EXPECT_EQ(received[1].targets.size(), 3u);
  EXPECT_EQ(node.deadlines_missed(), 0);
}

TEST_F(NodeTest, WaitsForItsOwnMeasurementForALimitedTime) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<std::pair<Time, models::RobotBelief>> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"), [&](const auto& belief) {
    received.emplace_back(clock_.now(), belief);
  });
  const Time t1 = kStart + 400ms;
  const auto look_comes = [&](Time instant, Duration late) {
    run_until(instant + late, {&node});
    world_.publish(bus::measurement_channel("Q1"), look("Q1", instant, {0.0, -1.0, 0.3}));
    deliver();
  };
  look_comes(t1, 72ms);  // the node does not expect observations yet
  look_comes(t1 + 500ms, 72ms);
  look_comes(t1 + 1000ms, 20ms);
  look_comes(t1 + 1500ms, 47ms);
  run_until(t1 + 3100ms, {&node});  // no further observations

  ASSERT_EQ(received.size(), 7u);
  const Duration made_after[] = {50ms, 77ms, 50ms, 52ms, Duration{83'333}, 50ms, 50ms};
  for (std::size_t i = 0; i < received.size(); ++i) {
    const Time instant = t1 + static_cast<int>(i) * 500ms;
    EXPECT_EQ(received[i].second.stamp.time, instant);
    EXPECT_LT(std::chrono::abs(received[i].first - instant - made_after[i]), 1us) << i;
  }
  EXPECT_EQ(received[1].second.inputs.size(), 2u);  // the late first observation and the second
  EXPECT_EQ(node.deadlines_missed(), 0);
}

TEST_F(NodeTest, CountsSkippedSteps) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<Time> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"), [&](const auto& belief) {
    received.push_back(belief.stamp.time);
  });
  node.tick(kStart + 1960ms);  // after the deadlines of 0.4, 0.9, 1.4 and 1.9 s
  deliver();
  EXPECT_EQ(received, std::vector<Time>{kStart + 1900ms});
  EXPECT_EQ(node.deadlines_missed(), 3);
  EXPECT_EQ(node.next_tick(), kStart + 2450ms);
}

TEST_F(NodeTest, CountsUnusableInputs) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  world_.publish(bus::measurement_channel("Q1"), look("Q2", kStart, {}));
  models::RobotBelief old = test::prior(kStart - 5s, {});
  old.robot = "Q2";
  world_.publish(bus::belief_channel("Q2"), old);
  deliver();
  run_until(kStart + 2s, {&node});
  auto counts = counts_of(node);
  EXPECT_EQ(counts["misaddressed"], 1);
  EXPECT_EQ(counts["stale_beliefs"], 1);  // counted once, not once per step
  EXPECT_EQ(counts["viewpoint_unknown"], 4);
}

TEST_F(NodeTest, UsesTeammatesMeasurementsButNotTheirPositions) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<models::RobotBelief> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                        [&](const auto& belief) { received.push_back(belief); });
  const Time t1 = kStart + 400ms;
  const auto mocap = sent_ref(world_, bus::kVicon, frame_at(t1 - 10ms, {{"Q1", {1.0, 2.0, 0.5}}}));
  const auto seen =
      sent_ref(world_, bus::measurement_channel("Q2"), look("Q2", t1, {0.0, -1.0, 0.3}));
  world_.publish(bus::measurement_channel("Q2"), look("Q1", t1, {}));  // wrong channel
  deliver();
  run_until(t1 + 60ms, {&node});
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].inputs, (std::vector<InputRef>{seen, mocap}));
  EXPECT_EQ(received[0].targets.size(), 3u);
  EXPECT_NEAR(received[0].viewpoint.world_from_body.x_m, 1.0, 1e-9);
}

TEST_F(NodeTest, UsesNoTeammatesMeasurementWithoutARadio) {
  scenario_.network.communication_range_m = 0.0;
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  const Time t1 = kStart + 400ms;
  world_.publish(bus::measurement_channel("Q2"), look("Q2", t1, {0.0, -1.0, 0.3}));
  deliver();
  run_until(t1 + 60ms, {&node});
  EXPECT_TRUE(node.filter().belief().targets.empty());
}

TEST_F(NodeTest, RefusesAnUnknownRobot) {
  EXPECT_THROW(EstimatorNode(robot_bus_, clock_, scenario_, "Q9"), UsageError);
}

// The node keeps 64 observations of each robot and the newest 256 poses.
TEST_F(NodeTest, KeepsTheNewestInputs) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<models::RobotBelief> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                        [&](const auto& belief) { received.push_back(belief); });
  const Time t1 = kStart + 400ms;
  const auto counters = [&] { return counts_of(node); };
  const auto pose = sent_ref(world_, bus::kVicon, frame_at(t1 - 10ms, {{"Q1", {1.0, 2.0, 0.5}}}));
  for (int i = 0; i < 255; ++i) {
    world_.publish(bus::kVicon, frame_at(t1 + 10ms + i * 1ms, {{"Q1", {9.0, 9.0, 0.5}}}));
    deliver();
  }
  std::vector<InputRef> looks;
  for (int i = 0; i < 2 * 64; ++i) {
    looks.push_back(
        sent_ref(world_, bus::measurement_channel("Q2"), look("Q2", t1 - Duration{i}, {})));
    deliver();
  }
  EXPECT_EQ(counters().count("looks_overflowed"), 0U);
  looks.push_back(sent_ref(world_, bus::measurement_channel("Q2"), look("Q2", t1, {})));
  deliver();
  EXPECT_EQ(counters()["looks_overflowed"], 1);
  run_until(t1 + 60ms, {&node});
  ASSERT_EQ(received.size(), 1u);
  looks.erase(looks.begin());
  looks.push_back(pose);
  EXPECT_EQ(received[0].inputs, looks);
  EXPECT_EQ(counters().count("viewpoint_unknown"), 0U);
  world_.publish(bus::kVicon, frame_at(t1 + 490ms, {{"Q1", {1.0, 2.0, 0.5}}}));
  for (int i = 0; i < 256; ++i) {
    world_.publish(bus::kVicon, frame_at(t1 + 510ms + i * 1ms, {{"Q1", {9.0, 9.0, 0.5}}}));
    deliver();
  }
  run_until(t1 + 560ms, {&node});
  EXPECT_EQ(counters()["viewpoint_unknown"], 1) << "256 poses have arrived since then";
}

// The robot's position at t is taken from an observation or a pose of the step that ends at t.
TEST_F(NodeTest, UsesPoseFromInputsOfThisStep) {
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1");
  std::vector<models::RobotBelief> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                        [&](const auto& belief) { received.push_back(belief); });
  const Time t1 = kStart + 400ms;
  const auto x_of_step = [&](int step) {
    deliver();
    run_until(t1 + step * 500ms + 90ms, {&node});
    return received.back().viewpoint.world_from_body.x_m;
  };
  world_.publish(bus::measurement_channel("Q1"), look("Q1", t1, {0.5, 0.0, 0.0}));
  world_.publish(bus::measurement_channel("Q1"), look("Q1", t1 - 100ms, {0.7, 0.0, 0.0}));
  EXPECT_EQ(x_of_step(0), 0.5) << "the newest of two, in any order of arrival";
  world_.publish(bus::measurement_channel("Q1"), look("Q1", t1, {0.6, 0.0, 0.0}));
  world_.publish(bus::kVicon, frame_at(t1 + Duration{1}, {{"Q1", {1.0, 0.0, 0.0}}}));
  EXPECT_NEAR(x_of_step(1), 1.0, 1e-9) << "an observation of the previous step is too old";
  world_.publish(bus::measurement_channel("Q1"),
                 look("Q1", t1 + 500ms + Duration{1}, {0.8, 0.0, 0.0}));
  world_.publish(bus::kVicon, frame_at(t1 + 990ms, {{"Q1", {2.0, 0.0, 0.0}}}));
  EXPECT_EQ(x_of_step(2), 0.8) << "an observation after the step is not used";
  world_.publish(bus::kVicon, frame_at(t1 + 1000ms, {{"Q1", {3.0, 0.0, 0.0}}}));
  auto hidden = frame_at(t1 + 1400ms, {{"Q1", {4.0, 0.0, 0.0}}});
  hidden.bodies[0].occluded = true;
  world_.publish(bus::kVicon, hidden);
  EXPECT_EQ(x_of_step(3), 0.8) << "the last position";
  EXPECT_EQ(node.counters().back().name, "viewpoint_unknown");
  EXPECT_EQ(node.counters().back().count, 1);
}

TEST_F(NodeTest, PublishesTheConfiguredBeliefs) {
  std::vector<std::pair<Time, std::size_t>> lookups;
  const auto believe = [&](Time t,
                           const std::vector<NamedMessage<models::RobotMeasurement>>& looks) {
    lookups.emplace_back(t, looks.size());
    return std::vector<models::TargetBelief>{
        {2, {Eigen::Vector4d::Ones(), Eigen::Matrix4d::Identity()}, t}};
  };
  EstimatorNode node(robot_bus_, clock_, scenario_, "Q1", believe);
  std::vector<models::RobotBelief> received;
  world_.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                        [&](const auto& belief) { received.push_back(belief); });
  EXPECT_EQ(node.name(), "ESTIMATOR_Q1");
  const Time t1 = kStart + 400ms;
  world_.publish(bus::measurement_channel("Q1"), look("Q1", t1, {}));
  models::RobotBelief mate = test::prior(t1 - 500ms, {});
  mate.robot = "Q3";
  world_.publish(bus::belief_channel("Q2"), mate);
  deliver();
  run_until(t1 + 90ms, {&node});
  EXPECT_EQ(lookups, (std::vector<std::pair<Time, std::size_t>>{{t1, 1U}}));
  ASSERT_EQ(received.size(), 1u);
  ASSERT_EQ(received[0].targets.size(), 1u);
  EXPECT_EQ(received[0].targets[0].target_id, 2);
  ASSERT_EQ(node.counters().size(), 1U);
  EXPECT_EQ(node.counters()[0].name, "misaddressed") << "the robot name does not match the channel";
  EXPECT_EQ(received[0].inputs.size(), 1U);
}

/// A log of all messages on the bus, in order, and its replay.
class Replay : public NodeTest {
 protected:
  /// Simulates two robots for `steps` steps with jitter: some observations are late or arrive
  /// together with the mocap frame.
  void fly(int steps) {
    EstimatorNode robot(robot_bus_, clock_, scenario_, "Q1");
    EstimatorNode mate(mate_bus_, clock_, scenario_, "Q2");
    const auto receiver = hub_.connect();
    receiver->subscribe("*", [&](std::string_view channel, std::span<const std::uint8_t> bytes) {
      log_.push_back({std::string(channel), {bytes.begin(), bytes.end()}});
    });
    std::vector<models::RobotMeasurement> late;
    for (int k = 0; k < steps; ++k) {
      const Time t = kStart + 400ms + k * 500ms;
      const std::map<std::string, Pose2> poses = {
          {"Q1", {2.0 * std::cos(0.3 * k), 2.0 * std::sin(0.3 * k), 0.1 * k}},
          {"Q2", {-2.0 * std::cos(0.2 * k), 1.0, wrap_to_pi(-0.2 * k)}}};
      world_.publish(bus::kVicon, frame_at(t - 10ms, poses));
      for (models::RobotMeasurement& set : late) {
        world_.publish(bus::measurement_channel("Q1"), set);
      }
      late.clear();
      auto set = look("Q1", t, poses.at("Q1"));
      if (k % 5 == 2) {
        late.push_back(set);
      } else {
        world_.publish(bus::measurement_channel("Q1"), set);
      }
      world_.publish(bus::measurement_channel("Q2"), look("Q2", t, poses.at("Q2")));
      deliver();
      run_until(t + 100ms, {&robot, &mate});
    }
    EXPECT_GT(robot.filter().counters().late_measurements, 0);
    EXPECT_GT(robot.filter().counters().missed_detections +
                  static_cast<std::int64_t>(robot.filter().belief().targets.size()),
              0);
    receiver->handle(0us);
  }

  struct Logged {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Logged> log_;
};

/// Plays a log, after `reorder` has changed its order, into a new bus with a replay node.
struct Player {
  explicit Player(const scenario::Scenario& scenario) : node{bus, clock, scenario, "Q1"} {
    receiver->subscribe(
        "REPLAY_BELIEF_Q1", [&](std::string_view, std::span<const std::uint8_t> bytes) {
          vantage_lcm::belief_t wire;
          ASSERT_GE(wire.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
          made.push_back(bus::from_wire(wire).value());
        });
  }

  template <class Log>
  void play(const Log& log) {
    for (const auto& event : log) {
      player->publish(event.channel, event.bytes);
      bus.handle(0us);
    }
    for (int i = 0; i < 30; ++i) {
      clock.set(clock.now() + 100ms);
      node.tick(clock.now());
    }
    receiver->handle(0us);
  }

  bus::InProcessHub hub;
  std::unique_ptr<bus::Transport> end = hub.connect();
  std::unique_ptr<bus::Transport> player = hub.connect();
  std::unique_ptr<bus::Transport> receiver = hub.connect();
  bus::VirtualClock clock{kStart};
  bus::Bus bus{*end, 9, "REPLAY_"};
  EstimatorReplayNode node;
  std::vector<models::RobotBelief> made;
};

std::vector<models::RobotBelief> beliefs_in(const auto& log) {
  std::vector<models::RobotBelief> beliefs;
  for (const auto& event : log) {
    if (event.channel == "BELIEF_Q1") {
      vantage_lcm::belief_t wire;
      wire.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size()));
      beliefs.push_back(bus::from_wire(wire).value());
    }
  }
  return beliefs;
}

TEST_F(Replay, ReproducesBeliefs) {
  fly(40);
  Player player(scenario_);
  player.play(log_);
  EXPECT_EQ(player.node.steps_redone(), 40);
  EXPECT_EQ(player.node.steps_rebased(), 0);
  EXPECT_EQ(player.node.differences(), 0);
  const auto flown = beliefs_in(log_);
  ASSERT_EQ(player.made.size(), flown.size());
  for (std::size_t k = 0; k < flown.size(); ++k) {
    EXPECT_TRUE(same_content(player.made[k], flown[k], 1e-9)) << "step " << k;
    EXPECT_EQ(player.made[k].inputs, flown[k].inputs);
    EXPECT_EQ(player.made[k].step, flown[k].step);
  }
}

TEST_F(Replay, IsIndependentOfDeliveryTimes) {
  fly(20);
  // The node's own beliefs arrive before the inputs from which they were computed.
  std::vector<Logged> jittered = log_;
  for (std::size_t i = 1; i < jittered.size(); ++i) {
    for (std::size_t j = i; j > 0 && j + 3 > i && jittered[j].channel == "BELIEF_Q1" &&
                            jittered[j - 1].channel != "BELIEF_Q1";
         --j) {
      std::swap(jittered[j], jittered[j - 1]);
    }
  }
  Player player(scenario_);
  player.play(jittered);
  EXPECT_EQ(player.node.steps_redone(), 20);
  EXPECT_EQ(player.node.inputs_missing(), 0);
  EXPECT_EQ(player.node.differences(), 0);
}

TEST_F(Replay, ContinuesFromTheLogWhenAnInputIsMissing) {
  fly(30);
  std::vector<Logged> holed = log_;
  int looks = 0;
  std::erase_if(holed, [&](const Logged& event) {
    return event.channel == "MEASUREMENT_Q1" && ++looks == 7;
  });
  Player player(scenario_);
  player.play(holed);
  EXPECT_EQ(player.node.inputs_missing(), 1);
  EXPECT_EQ(player.node.steps_rebased(), 1);
  EXPECT_EQ(player.node.steps_redone(), 29);
  EXPECT_EQ(player.node.differences(), 0);  // no late observation precedes the loss
  EXPECT_TRUE(same_content(player.made.front(), beliefs_in(log_).front(), 1e-9));
}

TEST_F(Replay, IsExactWhicheverLogEventsAreLost) {
  fly(40);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<Logged> holed = log_;
    std::erase_if(holed, [&](const Logged&) { return random() % 20 == 0; });
    Player player(scenario_);
    player.play(holed);
    EXPECT_EQ(player.node.differences(), 0) << "seed " << seed;
    EXPECT_GT(player.node.steps_redone(), 10) << "seed " << seed;
  }
}

TEST_F(Replay, DetectsABeliefThatContradictsItsInputs) {
  fly(10);
  scenario_.estimator.target_model.q *= 1.001;  // simulates a different version of the estimator
  Player player(scenario_);
  player.play(log_);
  EXPECT_GT(player.node.differences(), 0);
}

}  // namespace
}  // namespace vantage::estimator
