#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/values.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr double kPrior_nats = 5.0;

TargetStatus target_of(std::optional<double> found_s, std::optional<double> entropy_nats) {
  TargetStatus out;
  out.name = "R3";
  out.discovered_s = found_s;
  out.discovered_by = found_s ? "Q2" : "";
  if (entropy_nats) {
    out.estimate.emplace();
  }
  out.entropy_nats = entropy_nats.value_or(kPrior_nats);
  return out;
}

TEST(TargetStory, ReportsDiscoveryLossAndNewSightingOnce) {
  struct Row {
    std::optional<double> found_s;
    std::optional<double> entropy_nats;
    std::string text;  // empty: no event
    TargetStory::State state;
  };
  using State = TargetStory::State;
  const std::vector<Row> rows = {
      {std::nullopt, std::nullopt, "", State::kSought},
      {3.0, std::nullopt, "R3 found by Q2", State::kKnown},
      {3.0, std::nullopt, "", State::kKnown},  // its first estimate is not evaluated yet
      {3.0, 1.0, "", State::kKnown},
      {3.0, 4.9, "", State::kKnown},
      {3.0, 5.0, "R3 lost: the estimate is as uncertain as before the target was found",
       State::kLost},
      {3.0, 4.9, "", State::kLost},  // within the hysteresis
      {3.0, 4.5, "R3 found again by Q1", State::kKnown},
      {3.0, std::nullopt, "R3 lost: no robot has an estimate", State::kLost},
      {3.0, std::nullopt, "", State::kLost}};
  TargetStory story(kPrior_nats);
  for (const Row& row : rows) {
    const auto event = story.on(target_of(row.found_s, row.entropy_nats), "Q1", from_utime(7));
    EXPECT_EQ(event ? event->text : "", row.text);
    EXPECT_EQ(story.state(), row.state) << row.text;
    if (event) {
      EXPECT_EQ(event->kind, row.text.find("lost") == std::string::npos ? "found" : "lost");
      EXPECT_EQ(event->time, from_utime(7));
    }
  }
}

models::RobotBelief belief_at(const std::string& robot, double at_s, std::vector<int> ids) {
  models::RobotBelief out;
  out.robot = robot;
  out.stamp.time = from_utime(1'000'000) + from_seconds(at_s);
  out.step = static_cast<std::int64_t>(2.0 * at_s);
  for (const int id : ids) {
    models::TargetBelief& target = out.targets.emplace_back();
    target.target_id = id;
    target.information.matrix = Eigen::Matrix2d::Identity() / 0.25;
    target.information.vector = target.information.matrix * Eigen::Vector2d(1.0, 2.0);
    target.last_seen = out.stamp.time;
  }
  return out;
}

/// Lets Q1 know R2 from the first step on, and Q3 measure it later.
void run_three_steps(std::int64_t sequence_of_notice, Notebook& notebook) {
  Stream stream(notebook);
  models::ScenarioNotice notice = lab_notice();
  notice.stamp.sequence = sequence_of_notice;
  stream.on(notice, notice.stamp.time);
  models::RobotMeasurement measurement;
  measurement.robot = "Q3";
  measurement.stamp.time = notice.stamp.time + from_seconds(1.4);
  measurement.detections.resize(1);
  measurement.detections[0].target_id = 1;
  stream.on(measurement, measurement.stamp.time);
  for (const double at_s : {0.5, 1.0, 1.5, 2.0}) {
    stream.on(belief_at("Q1", at_s, {1}), notice.stamp.time + from_seconds(at_s));
  }
}

TEST(TargetsJson, NamesTheRobotsThatFoundAndLastSawATarget) {
  Notebook notebook;
  run_three_steps(0, notebook);
  const Json targets = notebook.of("/targets/status").back().at("targets");
  ASSERT_EQ(targets.size(), 5U);
  EXPECT_EQ(targets[0], (Json{{"name", "R1"}, {"state", "sought"}}));
  const Json& known = targets[1];
  EXPECT_EQ(known.at("state"), "known");
  EXPECT_EQ(known.at("found_by"), "Q1");
  EXPECT_NEAR(known.at("found_s").get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(known.at("sigma_m").get<double>(), 0.5, 1e-9);
  EXPECT_FALSE(known.contains("error_m")) << "no truth was received";
  EXPECT_EQ(known.at("seen_by"), "Q3") << "the last robot that measured it";
  EXPECT_NEAR(known.at("unseen_s").get<double>(), 0.6, 1e-9);
  const std::vector<Json> events = notebook.of("/events");
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].at("message"), "R2 found by Q1");
}

TEST(TargetsJson, OmitsADiscoveryBeforeTheViewBegan) {
  Notebook notebook;
  run_three_steps(4, notebook);
  const Json known = notebook.of("/targets/status").back().at("targets")[1];
  EXPECT_EQ(known.at("state"), "known");
  EXPECT_FALSE(known.contains("found_s"));
  EXPECT_FALSE(known.contains("found_by"));
  EXPECT_TRUE(notebook.of("/events").empty());
}

TEST(Stream, BeginsAgainWithASecondTrialOfTheSameScenario) {
  Notebook notebook;
  Stream stream(notebook);
  models::ScenarioNotice notice = lab_notice();
  notice.stamp.run_id = 1;
  const Time start = notice.stamp.time;
  stream.on(notice, start);
  stream.on(belief_at("Q1", 0.5, {1}), start + from_seconds(0.5));
  notice.stamp.run_id = 2;
  stream.on(notice, start + from_seconds(20.0));
  stream.on(belief_at("Q1", 20.5, {}), start + from_seconds(20.5));
  ASSERT_EQ(notebook.of("/scenario").size(), 2U);
  EXPECT_NE(notebook.of("/scenario")[0].at("session"), notebook.of("/scenario")[1].at("session"));
  EXPECT_EQ(notebook.of("/targets/status").front().at("targets")[1].at("state"), "known");
  EXPECT_EQ(notebook.of("/targets/status").back().at("targets")[1].at("state"), "sought");
}

TEST(HealthStory, NamesLostMessagesAndIgnoresRejections) {
  struct Row {
    std::int64_t missed;
    std::vector<models::NamedCount> counters;
    std::string text;  // empty: no event
  };
  const std::vector<Row> rows = {
      {0, {{"gated", 1}}, ""},
      {0, {{"gated", 1}, {"jammed_looks", 4}, {"busy_us", 9}}, ""},
      {2, {}, "SIM: degraded: 2 deadlines missed"},
      {0, {{"gated", 3}, {"PLAN_Q1.lost", 5}}, "SIM: degraded: 5 PLAN_Q1.lost"},
      {1,
       {{"a", 1}, {"b", 1}, {"c", 1}, {"d", 1}},
       "SIM: degraded: 1 deadlines missed, 1 a, 1 b, 2 more"},
      {0, {}, "SIM: degraded: drops, missed deadlines or other errors"}};
  for (const Row& row : rows) {
    HealthStory story;
    models::ProcessHealth health;
    health.process = "SIM";
    health.state = models::ProcessState::kRunning;
    EXPECT_FALSE(story.on(health));
    health.state = models::ProcessState::kDegraded;
    health.deadlines_missed = row.missed;
    health.counters = row.counters;
    const auto event = story.on(health);
    EXPECT_EQ(event ? event->text : "", row.text);
  }
}

}  // namespace
}  // namespace vantage::logs::foxglove
