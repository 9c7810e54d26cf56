#include "localizer/app/node.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "localizer/app/replay_node.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/localizer/app/pair_scenario.hpp"

namespace vantage::localizer {
namespace {

using namespace std::chrono_literals;

const Time kStart = from_utime(1'700'000'000'000'000);

/// Robot A with its localizer, a teammate that sends poses, and a replay of A.
class LocalizerNodeTest : public ::testing::Test {
 public:
  LocalizerNodeTest() {
    world_.subscribe<models::PoseEstimate>(
        bus::pose_channel("A"), [this](const auto& estimate) { poses_.push_back(estimate); });
    bus::Channel<models::PoseEstimate> replayed{"REPLAY_POSE_A"};
    world_.subscribe<models::PoseEstimate>(
        replayed, [this](const auto& estimate) { replayed_.push_back(estimate); });
  }

  void deliver() {
    while (world_.handle(0us) + robot_bus_.handle(0us) + replay_bus_.handle(0us) > 0) {
    }
  }

  void send_odometry(double t_s, const Eigen::Vector3d& motion, const std::string& robot = "A") {
    models::OdometryReport odometry;
    odometry.stamp.time = kStart + from_seconds(t_s);
    odometry.robot = robot;
    odometry.interval = Duration{100'000};
    odometry.motion_body = motion;
    world_.publish(bus::odometry_channel("A"), odometry);
  }

  void send_mocap(double t_s, const Pose2& a, bool occluded = false) {
    models::MocapFrame frame;
    frame.stamp.time = frame.arrival = kStart + from_seconds(t_s);
    frame.bodies = {{"A", lift(a, 1.0), occluded}};
    world_.publish(bus::kVicon, frame);
  }

  /// Sends exact sightings of all landmarks, stamped 0.03 s after the exposure at `t_s`.
  void send_sightings(double t_s, const Pose2& a) {
    models::SightingReport report;
    report.stamp.time = kStart + from_seconds(t_s);
    report.robot = "A";
    for (const scenario::LandmarkSpec& landmark : spec_.landmarks) {
      const Eigen::Vector2d p_m = inverse(a) * landmark.position_m;
      report.sightings.push_back({kStart + from_seconds(t_s + 0.03), landmark.id, p_m.norm(),
                                  std::atan2(p_m.y(), p_m.x())});
    }
    world_.publish(bus::sightings_channel("A"), report);
  }

  /// Delivers all messages and ticks `node` until `t_s`.
  void run_until(double t_s, bus::Node& node) {
    deliver();
    while (node.next_tick() <= kStart + from_seconds(t_s)) {
      clock_.set(node.next_tick());
      node.tick(clock_.now());
      deliver();
    }
    clock_.set(kStart + from_seconds(t_s));
  }

  std::int64_t count(const bus::Node& node, const std::string& name) const {
    for (const models::NamedCount& each : node.counters()) {
      if (each.name == name) {
        return each.count;
      }
    }
    return 0;
  }

  scenario::Scenario scenario_ = scenario::parse_scenario(test::kPairScenario, "pair.yaml");
  scenario::LocalizerSpec spec_ = *scenario::localizer_of(scenario_);
  bus::VirtualClock clock_{kStart};
  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> world_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> robot_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> replay_end_ = hub_.connect();
  bus::Bus world_{*world_end_, 1};
  bus::Bus robot_bus_{*robot_end_, 2};
  bus::Bus replay_bus_{*replay_end_, 3, "REPLAY_"};
  std::vector<models::PoseEstimate> poses_;
  std::vector<models::PoseEstimate> replayed_;
};

/// Moves A along x at 0.5 m/s for `steps` steps; motion capture sees it until `seen_steps`.
void drive(LocalizerNodeTest& test, LocalizerNode& node, int steps, int seen_steps) {
  for (int k = 1; k <= steps; ++k) {
    const double t_s = 0.1 * k;
    test.send_mocap(t_s, {0.05 * k, 0.0, 0.0}, k > seen_steps);
    test.send_odometry(t_s, {0.05, 0.0, 0.0});
    test.run_until(t_s + 0.05, node);
  }
}

TEST_F(LocalizerNodeTest, PublishesThePoseOfMotionCaptureWhileItIsSeen) {
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  drive(*this, node, 10, 10);
  ASSERT_EQ(poses_.size(), 10U);
  const models::PoseEstimate& last = poses_.back();
  EXPECT_EQ(last.stamp.time, kStart + 1s);
  EXPECT_EQ(last.step, 9);
  EXPECT_EQ(last.source, models::PoseSource::kMotionCapture);
  EXPECT_NEAR(last.world_from_body.x_m, 0.5, 1e-6);
  EXPECT_LT(last.covariance(0, 0), 1e-4);
  EXPECT_LT(last.age_s, 0.01);
}

TEST_F(LocalizerNodeTest, ContinuesByOdometryWithGrowingCovarianceWhenMocapEnds) {
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  drive(*this, node, 60, 10);
  const models::PoseEstimate& last = poses_.back();
  EXPECT_EQ(last.source, models::PoseSource::kLocalizer);
  EXPECT_NEAR(last.world_from_body.x_m, 3.0, 0.01);
  EXPECT_GT(last.covariance(0, 0), poses_[20].covariance(0, 0));
  EXPECT_NEAR(last.age_s, 5.0, 0.11);
}

TEST_F(LocalizerNodeTest, CorrectsSightingsForTheLatencyOfTheSensor) {
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  for (int k = 1; k <= 20; ++k) {
    const double t_s = 0.1 * k;
    send_odometry(t_s, {0.1, 0.0, 0.0});  // 1 m/s: 0.03 s are 3 cm
    send_sightings(t_s - 0.05, {0.1 * k - 0.05, 0.0, 0.0});
    run_until(t_s + 0.05, node);
  }
  ASSERT_TRUE(node.localizer().is_placed());
  EXPECT_EQ(poses_.back().source, models::PoseSource::kLocalizer);
  EXPECT_NEAR(poses_.back().world_from_body.x_m, 2.0, 0.01);
}

TEST_F(LocalizerNodeTest, CountsMisaddressedMessagesAndMissedInstants) {
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  send_odometry(0.1, {0.0, 0.0, 0.0}, "B");
  run_until(0.15, node);
  EXPECT_EQ(count(node, "localizer.misaddressed"), 1);
  EXPECT_TRUE(poses_.back().inputs.empty());
  clock_.set(kStart + 1s);
  node.tick(clock_.now());
  EXPECT_EQ(node.deadlines_missed(), 7);  // the instants 0.2 to 0.8 s have no step
}

TEST_F(LocalizerNodeTest, SendsMotionToTeammatesInEverySecondMessage) {
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  for (int k = 1; k <= 4; ++k) {
    send_odometry(0.1 * k, {0.05, 0.0, 0.0});
    run_until(0.1 * k + 0.05, node);
  }
  ASSERT_EQ(poses_.size(), 4U);
  EXPECT_FALSE(poses_[2].increments.empty());
  EXPECT_TRUE(poses_[3].increments.empty());
}

TEST_F(LocalizerNodeTest, RefusesARobotWithoutALocalizer) {
  EXPECT_THROW(LocalizerNode(robot_bus_, clock_, scenario_, "C"), UsageError);
  scenario_.source_text.clear();
  EXPECT_THROW(LocalizerNode(robot_bus_, clock_, scenario_, "A"), UsageError);
}

TEST_F(LocalizerNodeTest, ReplaysEveryPoseToTheBit) {
  LocalizerReplayNode replay(replay_bus_, clock_, scenario_, "A");
  LocalizerNode node(robot_bus_, clock_, scenario_, "A");
  drive(*this, node, 30, 10);
  ASSERT_EQ(replayed_.size(), poses_.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_EQ(replayed_[i].step, poses_[i].step);
    EXPECT_EQ(replayed_[i].world_from_body, poses_[i].world_from_body);
    EXPECT_EQ(replayed_[i].covariance, poses_[i].covariance);
    EXPECT_EQ(replayed_[i].inputs, poses_[i].inputs);
  }
  EXPECT_EQ(count(replay, "steps_skipped"), 0);
}

// A replay cannot continue behind a missing input, because POSE_R does not contain the filter.
TEST_F(LocalizerNodeTest, ReplayStopsAtAMissingInput) {
  LocalizerReplayNode replay(replay_bus_, clock_, scenario_, "A");
  for (std::int64_t step = 0; step < 6; ++step) {
    models::PoseEstimate logged;
    logged.stamp.time = kStart + (step + 1) * kIncrement;
    logged.robot = "A";
    logged.step = step;
    logged.increment = kIncrement;
    if (step == 2) {
      logged.inputs = {{"ODOMETRY_A", 9, 9}};
    }
    world_.publish(bus::pose_channel("A"), logged);
  }
  run_until(3.0, replay);
  EXPECT_EQ(replayed_.size(), 2U);
  EXPECT_EQ(count(replay, "inputs_missing"), 1);
  EXPECT_EQ(count(replay, "steps_skipped"), 4);
}

}  // namespace
}  // namespace vantage::localizer
