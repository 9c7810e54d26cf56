#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/stream.hpp"
#include "test/logs/foxglove_notebook.hpp"

// Tests messages that a stream publishes when something changes.

namespace vantage::logs::foxglove {
namespace {

TEST(Stream, ReportsAChannelWithTwoPublishersOnce) {
  Notebook notebook;
  Stream stream(notebook);
  for (int k = 0; k < 12; ++k) {
    stream.on_publisher("MEASUREMENT_Q1", 5 + k % 2, from_utime(100 + k));
    stream.on_publisher("MEASUREMENT_Q2", 5, from_utime(100 + k));
  }
  ASSERT_EQ(notebook.of("/events").size(), 1U);
  const Json event = notebook.of("/events")[0];
  EXPECT_EQ(event.at("name"), "two_publishers");
  EXPECT_EQ(
      event.at("message"),
      "MEASUREMENT_Q1: two processes publish this channel; only the messages of one are used");
}

TEST(Stream, RecoloursRobotsWhenJammingChanges) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(models::AttackNotice{{from_utime(5), 0, 0}, {"Q3"}}, from_utime(6));
  EXPECT_TRUE(notebook.of("/robots").empty()) << "the team is unknown";
  EXPECT_EQ(notebook.of("/attack").at(0).at("jammed"), Json::array({"Q3"}));
  stream.on(lab_notice(), from_utime(7));
  const auto words = [&](std::size_t robot) {
    return notebook.of("/robots").back().at("entities")[robot].at("texts")[0].at("text");
  };
  EXPECT_EQ(words(2), "Q3 jammed") << "jammed before the scenario was received";
  EXPECT_EQ(words(0), "Q1");
  stream.on(models::AttackNotice{{from_utime(8), 0, 0}, {}}, from_utime(9));
  EXPECT_EQ(words(2), "Q3");
  const Json robot = notebook.of("/robots").back().at("entities")[2];
  EXPECT_EQ(robot.at("timestamp"), to_json(from_utime(8)));
  EXPECT_EQ(notebook.of("/views").size(), 2U);
}

// The time of a record is the reception time of its message. The time in its content is the
// message's stamp.
TEST(Stream, SeparatesReceptionTimeAndDisplayTime) {
  Notebook notebook;
  Stream stream(notebook);
  models::ScenarioNotice notice = lab_notice();
  notice.stamp.time = from_utime(5);
  stream.on(notice, from_utime(7));
  models::MocapFrame frame;
  frame.stamp.time = from_utime(6);
  frame.bodies.push_back({"Q1", {}, false});
  stream.on(frame, from_utime(8));
  models::AttackNotice attack{{from_utime(9), 0, 0}, {"Q2"}};
  stream.on(attack, from_utime(11));
  struct Row {
    const char* topic;
    std::size_t scene;
    int shown_us;
    int received_us;
  };
  for (const Row& row : std::vector<Row>{{"/world", 0, 5, 7},
                                         {"/targets", 0, 5, 7},
                                         {"/robots", 0, 5, 7},
                                         {"/views", 0, 5, 7},
                                         {"/tracks", 0, 6, 8},
                                         {"/robots", 1, 9, 11},
                                         {"/views", 1, 9, 11}}) {
    std::vector<const Notebook::Record*> records;
    for (const Notebook::Record& record : notebook.records) {
      if (record.topic == row.topic) {
        records.push_back(&record);
      }
    }
    ASSERT_GT(records.size(), row.scene) << row.topic;
    EXPECT_EQ(records[row.scene]->time, from_utime(row.received_us)) << row.topic;
    EXPECT_EQ(notebook.of(row.topic)[row.scene].at("entities")[0].at("timestamp"),
              to_json(from_utime(row.shown_us)))
        << row.topic;
  }
}

TEST(Stream, ReportsCommandsAndEmergencyStops) {
  Notebook notebook;
  Stream stream(notebook);
  models::OperatorCommand command;
  command.stamp.time = from_utime(5);
  const auto published_event = [&](models::OperatorAction action, const std::string& robot) {
    const std::size_t before = notebook.of("/events").size();
    command.action = action;
    command.robot = robot;
    stream.on(command, from_utime(6));
    const std::vector<Json> events = notebook.of("/events");
    if (events.size() == before) {
      return std::string("nothing");
    }
    EXPECT_EQ(events.back().at("name"), "command");
    EXPECT_EQ(events.back().at("timestamp"), to_json(from_utime(5)));
    EXPECT_EQ(events.back().at("level"), action == models::OperatorAction::kEmergencyStop ? 4 : 2);
    return events.back().at("message").get<std::string>();
  };
  using models::OperatorAction;
  EXPECT_EQ(published_event(OperatorAction::kHeartbeat, ""), "nothing");
  EXPECT_EQ(published_event(OperatorAction::kArm, "Q1"), "operator: arm Q1");
  EXPECT_EQ(published_event(OperatorAction::kTakeOff, ""), "operator: take off all");
  EXPECT_EQ(published_event(OperatorAction::kFollow, "Q2"), "operator: follow Q2");
  EXPECT_EQ(published_event(OperatorAction::kHold, ""), "operator: hold all");
  EXPECT_EQ(published_event(OperatorAction::kLand, ""), "operator: land all");
  EXPECT_EQ(published_event(OperatorAction::kEmergencyStop, "Q1"), "operator: emergency stop Q1");
}

TEST(Stream, ReportsEachChangeOnce) {
  Notebook notebook;
  Stream stream(notebook);
  const auto events = [&] { return notebook.of("/events").size(); };
  models::VehicleStatus status;
  for (const char* robot : {"Q1", "Q2"}) {
    status.robot = robot;
    status.state = models::FlightState::kHold;
    stream.on(status, Time{});
    stream.on(status, Time{});
  }
  EXPECT_EQ(events(), 2U);
  models::ProcessHealth health;
  for (const char* process : {"SIM", "PLANNER_Q1"}) {
    health.process = process;
    health.state = models::ProcessState::kDegraded;
    stream.on(health, Time{});
    stream.on(health, Time{});
  }
  EXPECT_EQ(events(), 4U);
  models::HostReport report;
  for (const char* host : {"LAB", "AIR"}) {
    report.host = host;
    report.processes.resize(1);
    report.processes[0].phase = models::SupervisedPhase::kGivenUp;
    stream.on(report, Time{});
    stream.on(report, Time{});
  }
  EXPECT_EQ(events(), 6U);
  stream.on(models::CollisionReport{}, Time{});
  stream.on(models::CollisionReport{}, Time{});
  EXPECT_EQ(events(), 8U) << "each contact is an event";
}

}  // namespace
}  // namespace vantage::logs::foxglove
