#include "logs/analysis/log_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <gtest/gtest.h>

#include "models/exchange/counts.hpp"
#include "scenario/reader/overrides.hpp"
#include "test/logs/file_support.hpp"
#include "tools/log/log_plot.hpp"
#include "tools/log/log_scenario.hpp"
#include "tools/log/log_text.hpp"
#include "trial/trial.hpp"

namespace vantage::tools {
namespace {

TEST(HopsOf, GroupsThreeCountersPerHop) {
  models::ProcessHealth health;
  LatencyRecord record;
  record.add(Duration{100});
  record.add(Duration{300});
  health.counters = {{"guard.holds", 3}, {"latency.lonely_p50_us", 7}};
  models::append_latency(health.counters, "latency.frame_setpoint", record);
  models::append_latency(health.counters, "latency.never", {});
  models::append_latency(health.counters, "wire.Q1.pose", record);
  const std::vector<logs::Hop> hops = logs::hops_of(health);
  ASSERT_EQ(hops.size(), 2U);
  EXPECT_EQ(hops[0].name, "frame_setpoint");
  EXPECT_NEAR(static_cast<double>(hops[0].p50_us), 100.0, LatencyRecord::kStepUs);
  EXPECT_EQ(hops[0].p99_us, 300);
  EXPECT_EQ(hops[0].max_us, 300);
  EXPECT_EQ(hops[1].name, "wire.Q1.pose");
}

TEST(SpreadOf, ReturnsOrderStatistics) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) {
    values.push_back(i);
  }
  const logs::Spread spread = logs::spread_of(values);
  EXPECT_EQ(spread.count, 101);
  EXPECT_DOUBLE_EQ(spread.mean_s, 50.0);
  EXPECT_EQ(spread.median_s, 50.0);
  EXPECT_EQ(spread.p95_s, 95.0);
  EXPECT_EQ(spread.worst_s, 100.0);
  EXPECT_EQ(spread.least_s, 0.0);
  EXPECT_EQ(logs::spread_of({}).count, 0);
}

class AnalyseLog : public ::testing::Test {
 protected:
  void SetUp() override {
    scenario::Overrides overrides;
    overrides.seed = 2;
    overrides.duration_s = 12.0;
    overrides.node_budget = 200;
    scenario_ = scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/lab.yaml", overrides);
    trial::TrialOptions options;
    options.log_path = folder_.file("trial.lcmlog");
    flown_ = trial::run_trial(scenario_, trial::trial_recipes(scenario_), options).summary;
  }
  logs::test::TemporaryFolder folder_;
  scenario::Scenario scenario_;
  logs::TrialSummary flown_;
};

TEST_F(AnalyseLog, AgreesWithTheMetricsOfTheTrial) {
  const logs::IndexedLog log(folder_.file("trial.lcmlog"));
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario_of(log));
  const logs::TrialSummary& read = analysis.summary;
  EXPECT_EQ(read.discovery_time_s, flown_.discovery_time_s);
  EXPECT_EQ(read.rmse_m, flown_.rmse_m);
  EXPECT_EQ(read.entropy_nats, flown_.entropy_nats);
  EXPECT_EQ(read.plans, flown_.plans);
  EXPECT_EQ(read.rounds_late, flown_.rounds_late);
  EXPECT_EQ(read.messages_lost, 0);
  EXPECT_TRUE(analysis.lost.empty());
  EXPECT_EQ(analysis.plans.size(), static_cast<std::size_t>(flown_.plans));
  ASSERT_EQ(analysis.deadlines.size(), 3U);
  for (const auto& [robot, record] : analysis.deadlines) {
    EXPECT_GT(record.margin.least_s, 0.0) << robot;
    EXPECT_EQ(record.late, 0) << robot;
  }
  // An observation at time t is included in the belief of time t, which is logged 0.1 step later.
  // Plans use beliefs that are at most one round old.
  const double step_s = scenario_.planner.step_s;
  EXPECT_NEAR(analysis.latencies.at("look → belief").median_s, 0.1 * step_s, 1e-6);
  EXPECT_GT(analysis.latencies.at("look → plan").least_s, 0.0);
  EXPECT_LE(analysis.latencies.at("look → plan").median_s,
            step_s * (scenario_.planner.execute_steps + 1));
}

TEST_F(AnalyseLog, EntropyDecreasesOverTime) {
  const logs::IndexedLog log(folder_.file("trial.lcmlog"));
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario_of(log));
  ASSERT_GE(analysis.course.size(), 20U);
  for (std::size_t i = 1; i < analysis.course.size(); ++i) {
    EXPECT_GT(analysis.course[i].at_s, analysis.course[i - 1].at_s);
    EXPECT_GE(analysis.course[i].discovered, analysis.course[i - 1].discovered);
  }
  EXPECT_GT(analysis.course.back().discovered, 0);
  EXPECT_LT(analysis.course.back().entropy_nats, analysis.course.front().entropy_nats);
}

TEST_F(AnalyseLog, ReturnsResultsThatGnuplotDraws) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  const logs::IndexedLog log(folder_.file("trial.lcmlog"));
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario_of(log));
  const std::string png = folder_.file("it's a plot.png");
  const auto drawn = draw_plot(plot_script(analysis, scenario_of(log), "a 'title'", png),
                               folder_.file("p.gp"), png);
  ASSERT_TRUE(drawn.ok()) << drawn.error().message;
  EXPECT_GT(std::filesystem::file_size(png), 20'000U);
}

// One event has a wrong stamp, as from a clock that was not set; the duration is computed from the
// others.
TEST_F(AnalyseLog, IgnoresAnOutlyingTime) {
  const logs::test::Bytes whole = logs::test::read_file(folder_.file("trial.lcmlog"));
  constexpr std::size_t kTimeAt = 12;  // offset of the time within an event
  std::size_t middle = 0;
  for (int i = 0; i < 500; ++i) {
    middle += logs::event_bytes_at(whole, middle);
  }
  const std::pair<std::size_t, std::uint8_t> breaks[] = {{0, 0x00}, {middle, 0x00}, {middle, 0x7f}};
  for (const auto& [event, byte] : breaks) {
    logs::test::Bytes broken = whole;
    std::fill_n(broken.begin() + static_cast<std::ptrdiff_t>(event + kTimeAt), 8, byte);
    logs::test::write_file(folder_.file("broken.lcmlog"), broken);
    const logs::IndexedLog log(folder_.file("broken.lcmlog"));
    EXPECT_NEAR(log.survey().duration_s(), 12.0, 1.0);
    for (const auto& [name, channel] : log.survey().channels) {
      EXPECT_LT(to_seconds(channel.gap_max), 12.0) << name;
    }
    const logs::LogAnalysis analysis = logs::analyse_log(log, scenario_of(log));
    EXPECT_NEAR(analysis.summary.duration_s, flown_.duration_s, 0.5);
    ASSERT_EQ(analysis.summary.discovery_time_s.size(), flown_.discovery_time_s.size());
    for (std::size_t i = 0; i < flown_.discovery_time_s.size(); ++i) {
      EXPECT_NEAR(analysis.summary.discovery_time_s[i].value_or(-1.0),
                  flown_.discovery_time_s[i].value_or(-1.0), 0.5);
    }
    EXPECT_LE(std::abs(analysis.summary.plans - flown_.plans), 1);
    for (const auto& [name, spread] : analysis.latencies) {
      EXPECT_LT(std::max(spread.worst_s, -spread.least_s), 12.0) << name;
    }
    const std::string text = to_json("a", log.survey()).dump();
    EXPECT_NE(text.find("\"times_outlying\":1"), std::string::npos) << text;
    std::filesystem::remove(folder_.file("broken.lcmlog.index"));
  }
}

}  // namespace
}  // namespace vantage::tools
