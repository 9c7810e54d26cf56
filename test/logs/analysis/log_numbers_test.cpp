// Compares every number of an analysis with the values of a log made by hand.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/record/log_writer.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

Time at_s(double seconds) { return kStart + from_seconds(seconds); }

class LogNumbers : public ::testing::Test {
 protected:
  template <class Message>
  void log(double logged_s, const std::string& channel, Message message) {
    message.stamp.run_id = message.stamp.run_id == 0 ? 1 : message.stamp.run_id;
    writer_.write(at_s(logged_s), channel, test::encoded(bus::to_wire(message)));
  }
  LogAnalysis analyse(const std::function<void(double)>& progress = {}) {
    writer_.close();
    const IndexedLog log(folder_.file("a.lcmlog"));
    return analyse_log(log, scenario_, progress);
  }

  void add_frame(double captured_s, double arrived_s, double logged_s, std::int64_t sequence) {
    models::MocapFrame frame;
    frame.stamp = {at_s(captured_s), 1, sequence};
    frame.arrival = at_s(arrived_s);
    log(logged_s, "VICON", frame);
  }
  void add_truth(double s) {
    models::TruthFrame truth;
    truth.stamp = {at_s(s), 1, static_cast<std::int64_t>(10.0 * s)};
    truth.bodies = {{"R1", 0, {{1.0, 0.0, 0.0}, Quaternion::Identity()}, Eigen::Vector3d::Zero()},
                    {"R2", 1, {{0.0, 2.0, 0.0}, Quaternion::Identity()}, Eigen::Vector3d::Zero()}};
    log(s, "TRUTH", truth);
  }
  void add_look(const std::string& robot, double s, double logged_s, std::int64_t sequence) {
    models::RobotMeasurement look;
    look.stamp = {at_s(s), 11, sequence};
    look.robot = robot;
    log(logged_s, "MEASUREMENT_" + robot, look);
  }
  static models::TargetBelief known(int id, double x_m, double y_m, double sigma_m) {
    models::TargetBelief out;
    out.target_id = id;
    out.information.matrix = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
    out.information.vector = out.information.matrix * Eigen::Vector2d(x_m, y_m);
    out.last_seen = kStart;
    return out;
  }
  void add_belief(const std::string& robot, double s, double logged_s, std::int64_t step,
                  std::vector<models::TargetBelief> targets,
                  std::vector<models::InputRef> inputs = {}) {
    models::RobotBelief belief;
    belief.stamp = {at_s(s), 21, step};
    belief.robot = robot;
    belief.step = step;
    belief.targets = std::move(targets);
    belief.inputs = std::move(inputs);
    log(logged_s, "BELIEF_" + robot, belief);
  }

  scenario::Scenario scenario_ =
      scenario::load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/lab.yaml");
  test::TemporaryFolder folder_;
  LogWriter writer_{folder_.file("a.lcmlog")};
};

TEST_F(LogNumbers, ReportsTheLatencyOfEachHop) {
  add_frame(0.10, 0.103, 0.105, 1);
  add_frame(0.20, 0.204, 0.212, 2);
  add_look("Q2", 0.45, 0.46, 4);
  add_look("Q1", 0.50, 0.51, 3);
  add_look("Q1", 0.55, 0.56, 5);  // not an input of any belief
  add_belief("Q1", 0.52, 0.57, 7, {},
             {{"MEASUREMENT_Q1", 11, 3}, {"MEASUREMENT_Q2", 11, 4}, {"MEASUREMENT_Q2", 12, 5}});
  add_belief("Q1", 0.54, 0.58, 8, {});
  models::RobotPlan plan;
  plan.stamp = {at_s(1.0), 1, 1};
  plan.robot = "Q1";
  plan.source = models::PlanSource::kSearched;
  plan.slot_start = at_s(0.6);
  plan.deadline = at_s(1.0);
  plan.finish = at_s(0.9);
  plan.cost = 5.5;
  plan.lower_bound = 4.0;
  plan.trajectory.start_time = at_s(1.0);
  plan.inputs = {{"BELIEF_Q1", 21, 7}, {"BELIEF_Q9", 21, 8}};
  log(0.91, "PLAN_Q1", plan);
  plan.robot = "Q2";
  plan.source = models::PlanSource::kShifted;
  plan.slot_start = at_s(0.7);
  plan.finish = at_s(1.25);
  plan.late = true;
  plan.lower_bound = -std::numeric_limits<double>::infinity();
  plan.inputs.clear();
  log(1.26, "PLAN_Q2", plan);
  plan.stamp.sequence = 2;
  plan.slot_start = at_s(1.7);
  plan.deadline = at_s(2.0);
  plan.finish = at_s(1.8);
  plan.late = false;
  log(1.9, "PLAN_Q2", plan);
  const LogAnalysis analysis = analyse();

  ASSERT_EQ(analysis.latencies.size(), 5U);
  const auto expect_spread = [](const Spread& found, double least_s, double worst_s,
                                std::int64_t count) {
    EXPECT_EQ(found.count, count);
    EXPECT_NEAR(found.least_s, least_s, 1e-9);
    EXPECT_NEAR(found.worst_s, worst_s, 1e-9);
    EXPECT_NEAR(found.mean_s, 0.5 * (least_s + worst_s), 1e-9);
  };
  expect_spread(analysis.latencies.at("capture → arrival"), 0.003, 0.004, 2);
  expect_spread(analysis.latencies.at("capture → log"), 0.005, 0.012, 2);
  expect_spread(analysis.latencies.at("look → belief"), 0.07, 0.07, 1);
  expect_spread(analysis.latencies.at("belief → plan"), 0.38, 0.38, 1);
  expect_spread(analysis.latencies.at("look → plan"), 0.4, 0.4, 1);

  ASSERT_EQ(analysis.deadlines.size(), 2U);
  const DeadlineRecord& first = analysis.deadlines.at("Q1");
  EXPECT_EQ(first.plans, 1);
  EXPECT_EQ(first.late, 0);
  EXPECT_EQ(first.fallbacks, 0);
  expect_spread(first.margin, 0.1, 0.1, 1);
  expect_spread(first.search, 0.3, 0.3, 1);
  const DeadlineRecord& second = analysis.deadlines.at("Q2");
  EXPECT_EQ(second.plans, 2);
  EXPECT_EQ(second.late, 1);
  EXPECT_EQ(second.fallbacks, 2);
  expect_spread(second.margin, -0.25, 0.2, 2);
  expect_spread(second.search, 0.1, 0.55, 2);

  ASSERT_EQ(analysis.plans.size(), 3U);
  EXPECT_NEAR(analysis.plans[0].at_s, 0.91 - 0.105, 1e-9) << "since the first event";
  EXPECT_EQ(analysis.plans[0].robot, "Q1");
  EXPECT_NEAR(analysis.plans[0].margin_s, 0.1, 1e-9);
  EXPECT_EQ(analysis.plans[0].gap_nat, 1.5);
  EXPECT_NEAR(analysis.plans[1].margin_s, -0.25, 1e-9);
  EXPECT_EQ(analysis.plans[1].gap_nat, std::nullopt) << "no bound was proven";
  EXPECT_EQ(analysis.summary.plans, 3);
  EXPECT_NEAR(analysis.summary.duration_s, 1.9 - 0.105, 1e-9);
}

// Each step has a point at the time when its first belief was logged. The point contains the errors
// of the steps that had been evaluated by that time.
TEST_F(LogNumbers, ReportsTheTeamsEntropyOverTime) {
  add_truth(0.0);
  for (std::int64_t step = 1; step <= 4; ++step) {
    const double s = 0.5 * static_cast<double>(step);
    add_belief("Q1", s, s + 0.1, step, {known(0, 1.0, 3.0, 1.0), known(1, 0.0, 6.0, 2.0)});
    add_belief("Q2", s, s + 0.2, step, {});
    add_truth(s + 0.25);
  }
  add_belief("Q1", 1.0, 2.4, 2, {});  // logged late
  const LogAnalysis analysis = analyse();
  ASSERT_EQ(analysis.course.size(), 4U);
  const double prior_nats =
      isotropic_entropy_nats(scenario_.estimator.undiscovered_position_sigma_m, 2);
  const double known_nats =
      (isotropic_entropy_nats(1.0, 2) + isotropic_entropy_nats(2.0, 2) + 3.0 * prior_nats) / 5.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const CoursePoint& point = analysis.course[i];
    EXPECT_NEAR(point.at_s, 0.5 * static_cast<double>(i + 1) + 0.1, 1e-9);
    EXPECT_EQ(point.discovered, 2);
    EXPECT_EQ(point.rmse_m.has_value(), i >= 2) << "two steps later";
    EXPECT_NEAR(point.entropy_nats, i >= 2 ? known_nats : prior_nats, 1e-9);
    if (point.rmse_m) {
      EXPECT_NEAR(*point.rmse_m, std::sqrt((9.0 + 16.0) / 2.0), 1e-9);
    }
  }
  ASSERT_TRUE(analysis.sets);
  // Both targets are beyond the OSPA cutoff of 1 m; Q2 has no estimates.
  EXPECT_NEAR(analysis.sets->ospa_m, 1.0, 1e-9);
  EXPECT_NEAR(analysis.sets->matched_rmse_m, 0.5 * std::sqrt(25.0 / 2.0), 1e-9);
}

// The loss is the larger of two numbers: the losses that processes reported, and the messages
// missing in the log.
class LossNumbers : public LogNumbers, public ::testing::WithParamInterface<std::int64_t> {};

TEST_P(LossNumbers, AreTheLargerOfReportedAndMissingMessages) {
  for (const std::int64_t sequence : {1, 2, 5, 6}) {
    const double s = 0.1 * static_cast<double>(sequence);
    add_frame(s, s, s, sequence);
  }
  add_look("Q1", 0.7, 0.7, 1);
  add_look("Q1", 0.8, 0.8, 3);
  models::ProcessHealth health;
  health.stamp = {at_s(0.9), 1, 1};
  health.process = "SIM";
  health.counters = {{"VICON.lost", GetParam()},
                     {"latency.a_p50_us", 1},
                     {"latency.a_p99_us", 2},
                     {"latency.a_max_us", 3}};
  log(0.9, "HEALTH_SIM", health);
  health.counters.resize(1);  // no longer reports losses in transit
  health.stamp.sequence = 2;
  log(1.0, "HEALTH_SIM", health);
  const LogAnalysis analysis = analyse();
  EXPECT_EQ(analysis.lost,
            (std::map<std::string, std::int64_t>{{"VICON", 2}, {"MEASUREMENT_Q1", 1}}));
  EXPECT_EQ(analysis.summary.messages_lost, std::max<std::int64_t>(3, GetParam()));
  ASSERT_EQ(analysis.hops.size(), 1U);
  ASSERT_EQ(analysis.hops.at("SIM").size(), 1U);
  EXPECT_EQ(analysis.hops.at("SIM")[0].name, "a");
  EXPECT_FALSE(analysis.sets) << "no truth was received";
  const nlohmann::ordered_json json = to_json(analysis);
  EXPECT_EQ(json.at("lost"), nlohmann::ordered_json({{"MEASUREMENT_Q1", 1}, {"VICON", 2}}));
  EXPECT_EQ(json.at("hops").at("SIM").at("a"),
            nlohmann::ordered_json({{"p50_us", 1}, {"p99_us", 2}, {"max_us", 3}}));
}

INSTANTIATE_TEST_SUITE_P(LessAndMore, LossNumbers, ::testing::Values(1, 7));

TEST_F(LogNumbers, ReportsProgress) {
  for (int i = 0; i < 2'500; ++i) {
    writer_.write(at_s(0.001 * i), "FOREIGN", test::Bytes(10, 1));
  }
  std::vector<double> shares;
  analyse([&](double share) { shares.push_back(share); });
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_NEAR(shares[0], 999.0 / 2'500.0, 1e-9);
  EXPECT_NEAR(shares[1], 1'999.0 / 2'500.0, 1e-9);
  EXPECT_EQ(shares[2], 1.0);
}

TEST(ToJson, ContainsEachNumberOfAnAnalysis) {
  const auto spread = [](double base) {
    return Spread{static_cast<std::int64_t>(base),
                  base + 0.1,
                  base + 0.2,
                  base + 0.3,
                  base + 0.4,
                  base + 0.5};
  };
  LogAnalysis analysis;
  analysis.sets = SetMeans{1.5, 2.5, 3.5};
  analysis.latencies["a"] = spread(10.0);
  analysis.deadlines["Q1"] = {4, 5, 6, spread(20.0), spread(30.0)};
  analysis.lost["X\x01"] = 7;
  const auto wanted_spread = [&](double base) {
    return nlohmann::ordered_json{{"count", static_cast<int>(base)}, {"mean_s", base + 0.1},
                                  {"median_s", base + 0.2},          {"p95_s", base + 0.3},
                                  {"worst_s", base + 0.4},           {"least_s", base + 0.5}};
  };
  const nlohmann::ordered_json json = to_json(analysis);
  EXPECT_EQ(json.at("per_robot").at("ospa_m"), 1.5);
  EXPECT_EQ(json.at("per_robot").at("swaps_per_min"), 2.5);
  EXPECT_EQ(json.at("per_robot").at("matched_rmse_m"), 3.5);
  EXPECT_EQ(json.at("latencies"), nlohmann::ordered_json({{"a", wanted_spread(10.0)}}));
  EXPECT_EQ(json.at("deadlines").at("Q1"),
            nlohmann::ordered_json({{"plans", 4},
                                    {"late", 5},
                                    {"fallbacks", 6},
                                    {"margin", wanted_spread(20.0)},
                                    {"search", wanted_spread(30.0)}}));
  EXPECT_EQ(json.at("lost"), nlohmann::ordered_json({{"X\\x01", 7}}));
  EXPECT_EQ(to_json(LogAnalysis{}).at("lost"), nlohmann::ordered_json::object());
  EXPECT_FALSE(to_json(LogAnalysis{}).at("per_robot").contains("ospa_m"));
}

TEST(SpreadOf, ReportsASingleValueAsEveryStatistic) {
  const Spread spread = spread_of({4.5});
  EXPECT_EQ(spread.count, 1);
  for (const double each :
       {spread.mean_s, spread.median_s, spread.p95_s, spread.worst_s, spread.least_s}) {
    EXPECT_EQ(each, 4.5);
  }
}

}  // namespace
}  // namespace vantage::logs
