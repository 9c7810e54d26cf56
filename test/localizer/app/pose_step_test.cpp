#include "localizer/app/pose_step.hpp"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "scenario/reader/scenario_yaml.hpp"
#include "test/localizer/app/pair_scenario.hpp"

namespace vantage::localizer {
namespace {

const Time kStart = from_utime(1'700'000'000'000'000);
const Duration kHour = std::chrono::hours(1);

template <class Message>
PoseInput input_of(Message message) {
  return {{}, std::make_shared<const Message>(std::move(message))};
}

models::OdometryReport odometry_at(Time time) {
  models::OdometryReport odometry;
  odometry.robot = "A";
  odometry.stamp.time = time;
  odometry.interval = kIncrement;
  odometry.motion_body = {0.02, 0.0, 0.0};
  return odometry;
}

models::SightingReport sighting_at(Time time) {
  models::SightingReport report;
  report.robot = "A";
  report.stamp.time = time;
  report.sightings = {{time, 10, 3.0, 0.3}};
  return report;
}

models::PoseEstimate estimate_at(Time time) {
  models::PoseEstimate estimate;
  estimate.robot = "B";
  estimate.stamp.time = time;
  estimate.increment = kIncrement;
  estimate.increments_from = time - kIncrement;
  estimate.increments = {Eigen::Vector3d(0.01, 0.0, 0.0)};
  return estimate;
}

models::MocapFrame frame_at(Time time) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.bodies.emplace_back().name = "A";
  return frame;
}

std::int64_t count_of(const PoseSteps& steps, const std::string& name) {
  for (const models::NamedCount& counter : steps.counters()) {
    if (counter.name == name) {
      return counter.count;
    }
  }
  return 0;
}

// One false time, for example of a host whose clock was wrong for a moment, must not block the
// inputs that follow.
TEST(PoseSteps, RefusesInputsFarInTheFutureAndUsesLaterOnes) {
  const scenario::Scenario scenario = scenario::parse_scenario(test::kPairScenario, "pair.yaml");
  PoseSteps steps(scenario, "A");
  PoseSteps undisturbed(scenario, "A");
  const auto inputs_at = [](Time time) {
    return std::vector{input_of(odometry_at(time)), input_of(sighting_at(time)),
                       input_of(estimate_at(time)), input_of(frame_at(time))};
  };
  static_cast<void>(steps.step(kStart, 0, inputs_at(kStart + kHour)));
  static_cast<void>(undisturbed.step(kStart, 0, {}));
  EXPECT_EQ(count_of(steps, "localizer.inputs_too_new"), 4);
  models::PoseEstimate pose;
  models::PoseEstimate expected;
  for (int i = 1; i <= 20; ++i) {
    const Time t = kStart + i * kIncrement;
    pose = steps.step(t, i, inputs_at(t));
    expected = undisturbed.step(t, i, inputs_at(t));
  }
  EXPECT_EQ(count_of(steps, "localizer.inputs_too_new"), 4);
  EXPECT_EQ(pose.source, models::PoseSource::kMotionCapture);
  EXPECT_EQ(pose.world_from_body, expected.world_from_body);
  EXPECT_EQ(pose.covariance, expected.covariance);
  EXPECT_EQ(pose.age_s, expected.age_s);
  EXPECT_EQ(pose.increments, expected.increments);
}

// The clocks of two hosts may differ a little.
TEST(PoseSteps, AcceptsInputsALittleNewerThanTheStep) {
  PoseSteps steps(scenario::parse_scenario(test::kPairScenario, "pair.yaml"), "A");
  static_cast<void>(steps.step(kStart, 0,
                               {input_of(sighting_at(kStart + PoseSteps::kAheadMax)),
                                input_of(frame_at(kStart + PoseSteps::kAheadMax))}));
  EXPECT_EQ(count_of(steps, "localizer.inputs_too_new"), 0);
}

}  // namespace
}  // namespace vantage::localizer
