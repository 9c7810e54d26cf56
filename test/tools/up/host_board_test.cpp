#include "tools/up/host_board.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::SupervisedPhase;

Time at_s(double s) { return from_utime(1'000'000'000) + from_seconds(s); }

scenario::Scenario two_hosts() {
  scenario::Scenario scenario;
  scenario.hosts = {{"LAB", {}}, {"AIR", {}}};
  return scenario;
}

models::SupervisedProcess process_of(const std::string& name,
                                     SupervisedPhase phase = SupervisedPhase::kRunning) {
  models::SupervisedProcess process;
  process.name = name;
  process.phase = phase;
  return process;
}

models::HostReport report_of(const std::string& host, std::int64_t run_id,
                             std::vector<models::SupervisedProcess> processes = {
                                 process_of("sim")}) {
  models::HostReport report;
  report.stamp.run_id = run_id;
  report.host = host;
  report.processes = std::move(processes);
  return report;
}

TEST(UsageMeter, ReturnsSharesPerInterval) {
  UsageMeter meter;
  SupervisedStatus status;
  status.name = "sim";
  status.pid = 7;
  models::SupervisedProcess process;
  meter.fill(status, UsageMeter::Reading{1'000'000, 50}, at_s(0.0), process);
  EXPECT_EQ(process.cpu_share, 0.0) << "the first reading gives no share";
  EXPECT_EQ(process.memory_bytes, 50);
  meter.fill(status, UsageMeter::Reading{1'250'000, 60}, at_s(1.0), process);
  EXPECT_DOUBLE_EQ(process.cpu_share, 0.25);
  meter.fill(status, UsageMeter::Reading{1'350'000, 60}, at_s(1.1), process);
  EXPECT_DOUBLE_EQ(process.cpu_share, 0.25) << "too early for another reading";
  status.pid = 8;
  meter.fill(status, UsageMeter::Reading{10'000, 60}, at_s(3.0), process);
  EXPECT_EQ(process.cpu_share, 0.0) << "a new process counts from 0";
  meter.fill(status, std::nullopt, at_s(4.0), process = {});
  EXPECT_EQ(process.memory_bytes, 0);
}

TEST(HostBoard, ReportsHostAppearanceSilenceAndReturn) {
  HostBoard board(two_hosts(), "LAB", 1, at_s(0.0));
  EXPECT_FALSE(board.on_report(report_of("LAB", 1), at_s(0.1))) << "the report of this host";
  EXPECT_TRUE(board.fallen_silent(at_s(3.0)).empty());
  EXPECT_EQ(board.fallen_silent(at_s(4.0)),
            std::vector<std::string>{"host AIR has sent no report for 4 s"});
  EXPECT_TRUE(board.fallen_silent(at_s(5.0)).empty()) << "reported only once";
  EXPECT_EQ(board.on_report(report_of("AIR", 2), at_s(6.0)), "host AIR is up");
  EXPECT_FALSE(board.on_report(report_of("AIR", 2), at_s(7.0)));
  EXPECT_EQ(board.fallen_silent(at_s(11.0)),
            std::vector<std::string>{"host AIR has been silent for 4 s"});
  EXPECT_EQ(board.on_report(report_of("AIR", 2), at_s(12.0)), "host AIR is received again");
  EXPECT_EQ(board.on_report(report_of("AIR", 3), at_s(13.0)), "host AIR was started again");
}

TEST(HostBoard, LimitsTheNumberOfHosts) {
  HostBoard board(two_hosts(), "LAB", 1, at_s(0.0));
  const std::vector<models::SupervisedProcess> many(5'000, process_of("x"));
  for (int i = 0; i < 6'000; ++i) {
    (void)board.on_report(
        report_of("X" + std::to_string(i), 7, i == 0 ? many : std::vector{many[0]}), at_s(1.0));
  }
  EXPECT_EQ(board.on_report(report_of("AIR", 2), at_s(2.0)), "host AIR is up")
      << "keeps its position";
  EXPECT_EQ(board.table(at_s(2.0)).size(), 1U + 1U + 1U + 1'024U + 31U);
}

TEST(HostBoard, EscapesControlCharacters) {
  HostBoard board(two_hosts(), "LAB", 1, at_s(0.0));
  models::SupervisedProcess process = process_of("sim\x1b[2J");
  process.last_end = "signal\n9";
  std::string all = board.on_report(report_of("A\x1b]0;x\x07", 2, {process}), at_s(1.0)).value();
  for (const std::string& line : board.table(at_s(1.0))) {
    all += line;
  }
  all += board.line(at_s(1.0));
  for (const std::string& line : board.fallen_silent(at_s(9.0))) {
    all += line;
  }
  EXPECT_TRUE(std::none_of(all.begin(), all.end(), [](unsigned char c) { return c < 0x20; }))
      << all;
  EXPECT_NE(all.find("sim\\x1B[2J"), std::string::npos);
}

TEST(HostBoard, ReportsDuplicateHostNameOnce) {
  HostBoard board(two_hosts(), "LAB", 1, at_s(0.0));
  const auto words = board.on_report(report_of("LAB", 9), at_s(1.0));
  ASSERT_TRUE(words);
  EXPECT_NE(words->find("as host LAB"), std::string::npos);
  EXPECT_FALSE(board.on_report(report_of("LAB", 9), at_s(2.0)));
}

TEST(HostBoard, ShowsEveryProcessAndMissingHosts) {
  HostBoard board(two_hosts(), "LAB", 1, at_s(0.0));
  board.on_report(report_of("LAB", 1,
                            {{"sim", SupervisedPhase::kRunning, 1, 0.4, 0.5, 3 << 20, "signal 9"},
                             {"vicon", SupervisedPhase::kWaiting, 0, 0.1, 0.0, 0, "exit 1"}}),
                  at_s(1.0));
  const auto rows = board.table(at_s(2.0));
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1], "AIR      no report for 2 s");
  EXPECT_EQ(
      rows[2],
      "LAB      sim              running         1      0.4 s   50.0 %     3.0 MiB  signal 9");
  EXPECT_NE(rows[3].find("waiting"), std::string::npos);
  EXPECT_EQ(board.line(at_s(2.0)), "AIR silent for 2 s, LAB 1/2");
}

TEST(HostBoard, LineIsEmptyForOneHealthyHost) {
  HostBoard board({}, kOnlyHost, 1, at_s(0.0));
  EXPECT_EQ(board.line(at_s(0.0)), "");
  board.on_report(report_of(kOnlyHost, 1), at_s(1.0));
  EXPECT_EQ(board.line(at_s(1.0)), "");
  board.on_report(report_of(kOnlyHost, 1, {process_of("sim", SupervisedPhase::kGivenUp)}),
                  at_s(2.0));
  EXPECT_EQ(board.line(at_s(2.0)), "LOCAL 0/1");
}

}  // namespace
}  // namespace vantage::tools
