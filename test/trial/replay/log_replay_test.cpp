#include "trial/replay/log_replay.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "core/check.hpp"
#include "logs/record/log_writer.hpp"
#include "scenario/reader/overrides.hpp"
#include "test/logs/file_support.hpp"
#include "tools/log/log_scenario.hpp"
#include "trial/trial.hpp"

namespace vantage::trial {
namespace {

using logs::test::Bytes;
using logs::test::TemporaryFolder;

/// A trial of 8 s and its log, run once for all tests.
class ReplayLog : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    scenario::Overrides overrides;
    overrides.seed = 5;
    overrides.duration_s = 8.0;
    fly("lab.yaml", overrides, trial());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string trial() { return folder_->file("trial.lcmlog"); }

  /// Runs a trial of a scenario of config/ with 300 nodes per slot.
  static logs::TrialSummary fly(const std::string& config, scenario::Overrides overrides,
                                const std::string& log_path) {
    overrides.node_budget = 300;
    const scenario::Scenario scenario =
        scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/" + config, overrides);
    TrialOptions options;
    options.log_path = log_path;
    return run_trial(scenario, trial_recipes(scenario), options).summary;
  }

  /// Returns the path of the trial's log with each event changed by `edit`, or omitted if `edit`
  /// returns false.
  static std::string edited(const std::function<bool(std::string_view, Bytes&)>& edit) {
    const logs::IndexedLog log(trial());
    std::string path = folder_->file("edited.lcmlog");
    logs::LogWriter writer(path, logs::Existing::kReplace);
    logs::LogScan scan = log.scan();
    while (const auto event = scan.next()) {
      Bytes data(event->data.begin(), event->data.end());
      if (edit(event->channel, data)) {
        writer.write(event->time, event->channel, data);
      }
    }
    return path;
  }

  static ReplayReport replay(const std::string& path, const std::string& node) {
    const logs::IndexedLog log(path);
    const scenario::Scenario scenario = tools::scenario_of(log);
    return replay_log(log, scenario, parse_replay_target(node, scenario));
  }

  /// Expects at least `least` decisions; all must be replayed and equal the logged ones bit for
  /// bit.
  static void expect_made_again(const std::string& path, const std::string& node, int least) {
    const ReplayReport report = replay(path, node);
    EXPECT_TRUE(report.outputs.is_exact()) << node;
    EXPECT_GE(report.outputs.replayed(), least) << node;
    EXPECT_EQ(report.not_replayed(), 0) << node;
  }

  struct Flown {
    scenario::Scenario scenario;
    std::string log_path;
    logs::TrialSummary summary;
  };
  /// Runs a trial of config/`name`.yaml; returns its scenario, log and summary.
  static Flown fly(const std::string& name, double duration_s, std::int64_t nodes,
                   std::optional<std::uint64_t> seed = {}) {
    scenario::Overrides overrides;
    overrides.seed = seed;
    overrides.duration_s = duration_s;
    overrides.node_budget = nodes;
    const std::string file = VANTAGE_SOURCE_DIR "/config/" + name + ".yaml";
    Flown flown{scenario::load_scenario_with(file, overrides), folder_->file(name + ".lcmlog"), {}};
    TrialOptions options;
    options.log_path = flown.log_path;
    flown.summary = run_trial(flown.scenario, trial_recipes(flown.scenario), options).summary;
    return flown;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> ReplayLog::folder_;

TEST_F(ReplayLog, ReproducesATeamWithMessageBudgetAndLossesExactly) {
  std::ifstream file(VANTAGE_SOURCE_DIR "/config/lab.yaml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string section = "\nnetwork:\n";
  ASSERT_NE(text.find(section), std::string::npos);
  text.insert(text.find(section) + section.size(),
              "  budget_kbitps: 24\n  simulation: {loss: 0.2, rate_kbitps: 0}\n");
  const std::string path = folder_->file("budget.yaml");
  std::ofstream(path) << text;
  scenario::Overrides overrides;
  overrides.duration_s = 8.0;
  overrides.node_budget = 300;
  const scenario::Scenario scenario = scenario::load_scenario_with(path, overrides);
  TrialOptions options;
  options.log_path = folder_->file("budget.lcmlog");
  ASSERT_GT(run_trial(scenario, trial_recipes(scenario), options).summary.messages_lost, 0);
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    expect_made_again(options.log_path, std::string("planner:") + robot, 7);
    expect_made_again(options.log_path, std::string("estimator:") + robot, 15);
  }
}

TEST_F(ReplayLog, ReproducesEveryPlanAndBeliefExactly) {
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    expect_made_again(trial(), std::string("planner:") + robot, 7);
    expect_made_again(trial(), std::string("estimator:") + robot, 15);
  }
}

// Motion capture ends 5 s after the start; then vehicles, sensors and planners use POSE_*.
TEST_F(ReplayLog, ReproducesPosesWithoutMotionCapture) {
  const Flown flown = fly("lab-nomocap", 12.0, 300);
  EXPECT_EQ(flown.summary.collisions, 0);
  EXPECT_GE(flown.summary.poses.samples, 3 * 60);
  EXPECT_LT(*flown.summary.poses.rmse_m, 0.15);
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    expect_made_again(flown.log_path, std::string("localizer:") + robot, 115);
    expect_made_again(flown.log_path, std::string("planner:") + robot, 11);
    expect_made_again(flown.log_path, std::string("estimator:") + robot, 23);
  }
}

TEST_F(ReplayLog, ReproducesTracksWithoutIdsAndPlansThatUseThem) {
  scenario::Overrides overrides;
  overrides.duration_s = 20.0;
  const std::string log_path = folder_->file("unlabelled.lcmlog");
  const logs::TrialSummary summary = fly("lab-unlabelled.yaml", overrides, log_path);
  EXPECT_EQ(summary.plans_missing, 0);
  EXPECT_EQ(summary.collisions, 0);
  EXPECT_GE(summary.discovered, 1);
  int tracks = 0;
  int told_in_parts = 0;
  const logs::IndexedLog log(log_path);
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (event->channel.starts_with("MEASUREMENT_")) {
      const auto look = bus::decode_wire<vantage_lcm::measurement_t>(event->data);
      for (const vantage_lcm::detection_t& each : look->detections) {
        EXPECT_EQ(each.target_id, models::kNoTargetId);
      }
    }
    if (event->channel.starts_with("BELIEF_")) {
      const auto belief = bus::decode_wire<vantage_lcm::belief_t>(event->data);
      for (const vantage_lcm::target_belief_t& each : belief->targets) {
        EXPECT_GE(each.target_id, models::kTrackLabelMin);
        ++tracks;
      }
    }
    if (event->channel.starts_with("MIXTURE_")) {
      const auto mixture = bus::decode_wire<vantage_lcm::mixture_t>(event->data);
      EXPECT_TRUE(bus::from_wire(*mixture));
      for (const vantage_lcm::target_mixture_t& each : mixture->targets) {
        EXPECT_GE(each.target_id, models::kTrackLabelMin);
        ++told_in_parts;
      }
    }
  }
  EXPECT_GT(tracks, 20);
  EXPECT_EQ(told_in_parts, tracks);
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    const ReplayReport plans = replay(log_path, std::string("planner:") + robot);
    EXPECT_TRUE(plans.outputs.is_exact()) << robot;
    EXPECT_GE(plans.outputs.replayed(), 19) << robot;
    EXPECT_EQ(plans.not_replayed(), 0) << robot;
    const ReplayReport beliefs = replay(log_path, std::string("estimator:") + robot);
    EXPECT_TRUE(beliefs.outputs.is_exact()) << robot;
    EXPECT_GE(beliefs.outputs.replayed(), 38) << robot;
    EXPECT_EQ(beliefs.not_replayed(), 0) << robot;
  }
}

// A log without mixtures is valid and has no differences. A plan that names a mixture as input can
// only be reproduced with that mixture.
TEST_F(ReplayLog, ReproducesMixturesAndPlansThatUseThem) {
  const auto [scenario, path, summary] = fly("field", 180.0, 300);
  EXPECT_EQ(summary.plans_missing, 0);
  int mixtures = 0;
  int planned_by = 0;
  std::string without = folder_->file("without.lcmlog");
  {
    logs::LogWriter writer(without, logs::Existing::kReplace);
    std::optional<vantage_lcm::mixture_t> open;  // its belief is the next event
    const logs::IndexedLog log(path);
    logs::LogScan scan = log.scan();
    while (const auto event = scan.next()) {
      if (event->channel == "MIXTURE_Q1") {
        open = bus::decode_wire<vantage_lcm::mixture_t>(event->data);
        ++mixtures;
        continue;
      }
      if (event->channel == "BELIEF_Q1" && open) {
        const auto belief = bus::decode_wire<vantage_lcm::belief_t>(event->data);
        EXPECT_EQ(belief->utime, open->utime);
        EXPECT_EQ(belief->step, open->step);
        open.reset();
      }
      if (event->channel == "PLAN_Q1") {
        const auto plan = bus::decode_wire<vantage_lcm::plan_t>(event->data);
        planned_by += std::any_of(plan->inputs.begin(), plan->inputs.end(),
                                  [](const auto& input) { return input.channel == "MIXTURE_Q1"; });
      }
      writer.write(event->time, event->channel, Bytes(event->data.begin(), event->data.end()));
    }
  }
  EXPECT_GE(mixtures, 40);
  EXPECT_GE(planned_by, 5);
  expect_made_again(path, "planner:Q1", 58);
  expect_made_again(path, "estimator:Q1", 358 + mixtures);
  expect_made_again(without, "estimator:Q1", 358);
  const ReplayReport plans = replay(without, "planner:Q1");
  EXPECT_TRUE(plans.outputs.is_exact());
  EXPECT_EQ(plans.not_replayed(), planned_by);
}

TEST_F(ReplayLog, ReproducesMapsUnderAttackAndPlansThatUseThem) {
  const auto [scenario, path, summary] = fly("mapping", 12.0, 300);
  EXPECT_EQ(summary.plans_missing, 0);
  EXPECT_EQ(summary.collisions, 0);
  EXPECT_EQ(summary.separation_violations, 0);
  ASSERT_TRUE(summary.map_entropy_nats);
  int jammed_scans = 0;
  std::map<std::string, std::vector<double>> entropies_nats;
  const logs::IndexedLog log(path);
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (event->channel == "SCAN_Q1") {
      jammed_scans += bus::decode_wire<vantage_lcm::scan_t>(event->data)->jammed;
    }
    if (event->channel.starts_with("MAP_")) {
      entropies_nats[std::string(event->channel)].push_back(
          bus::decode_wire<vantage_lcm::map_t>(event->data)->entropy_nat);
    }
  }
  EXPECT_GE(jammed_scans, 6) << "from 8 s on";
  ASSERT_EQ(entropies_nats.size(), 3U);
  for (const auto& [channel, of_robot] : entropies_nats) {
    EXPECT_GE(of_robot.size(), 22U);
    EXPECT_LT(of_robot.back(), 0.8 * of_robot.front()) << channel;
  }
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    expect_made_again(path, std::string("planner:") + robot, 11);
    constexpr int kBeliefsAndMaps = 2 * 22;
    expect_made_again(path, std::string("estimator:") + robot, kBeliefsAndMaps);
  }
}

TEST_F(ReplayLog, ReproducesRoundsUnderAttack) {
  const Flown flown = fly("lab-attack", 8.0, 300, 2);
  ASSERT_EQ(flown.scenario.planner.attacks_max, 1);
  int proposals = 0;
  int jammed_looks = 0;
  const logs::IndexedLog log(flown.log_path);
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    proposals += event->channel.starts_with("PROPOSAL_") ? 1 : 0;
    if (event->channel == "MEASUREMENT_Q1") {
      jammed_looks += bus::decode_wire<vantage_lcm::measurement_t>(event->data)->jammed;
    }
  }
  EXPECT_GE(proposals, 3 * 7);
  EXPECT_GE(jammed_looks, 4);
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    expect_made_again(flown.log_path, std::string("planner:") + robot, 7);
  }
}

TEST_F(ReplayLog, ReproducesPlansAndProposalsOfLocalSearch) {
  const Flown flown = fly("lab-energy", 14.0, 1000, 2);
  ASSERT_EQ(flown.scenario.planner.team_algorithm, scenario::TeamAlgorithm::kLocalSearch);
  std::map<std::string, int> logged_counts;
  const logs::IndexedLog log(flown.log_path);
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    logged_counts[std::string(event->channel)]++;
  }
  for (const std::string robot : {"Q1", "Q2", "Q3"}) {
    const ReplayReport outputs = replay(flown.log_path, "planner:" + robot);
    EXPECT_TRUE(outputs.outputs.is_exact()) << robot;
    EXPECT_GE(logged_counts["TEAM_PROPOSAL_" + robot], 4) << robot;
    EXPECT_EQ(outputs.outputs.replayed(),
              logged_counts["PLAN_" + robot] + logged_counts["TEAM_PROPOSAL_" + robot]);
    EXPECT_EQ(outputs.not_replayed(), 0) << robot;
  }
}

TEST_F(ReplayLog, NamesTheFirstMemberThatDiffers) {
  int seen = 0;
  const std::string path = edited([&](std::string_view channel, Bytes& data) {
    if (channel == "PLAN_Q2" && ++seen == 4) {
      auto wire = bus::decode_wire<vantage_lcm::plan_t>(data).value();
      wire.segments.at(1).speed_mps += 1e-12;
      data = logs::test::encoded(wire);
    }
    return true;
  });
  const ReplayReport report = replay(path, "planner:Q2");
  EXPECT_FALSE(report.outputs.is_exact());
  ASSERT_TRUE(report.outputs.first_difference().has_value());
  EXPECT_EQ(report.outputs.first_difference()->member, "segments[1].speed_mps");
  EXPECT_NE(report.outputs.first_difference()->logged, report.outputs.first_difference()->replayed);
  EXPECT_FALSE(report.outputs.first_difference()->inputs.empty());
}

TEST_F(ReplayLog, DetectsAChangedInput) {
  int seen = 0;
  const std::string path = edited([&](std::string_view channel, Bytes& data) {
    if (channel == "MEASUREMENT_Q1") {
      auto wire = bus::decode_wire<vantage_lcm::measurement_t>(data).value();
      if (wire.num_detections > 0 && ++seen == 1) {
        wire.detections[0].z[0] += 1e-9;
        data = logs::test::encoded(wire);
      }
    }
    return true;
  });
  ASSERT_GE(seen, 1);
  EXPECT_GE(replay(path, "estimator:Q1").outputs.different(), 1);
}

TEST_F(ReplayLog, ReportsOutputsThatCannotBeReproduced) {
  int seen = 0;
  const std::string path = edited(
      [&](std::string_view channel, Bytes&) { return channel != "BELIEF_Q1" || ++seen != 10; });
  const ReplayReport plans = replay(path, "planner:Q1");
  EXPECT_EQ(plans.outputs.different(), 0);
  EXPECT_GE(plans.not_replayed(), 0);
  EXPECT_LE(plans.not_replayed(), 1);
  const ReplayReport beliefs = replay(path, "estimator:Q1");
  EXPECT_EQ(beliefs.outputs.different(), 0);
  EXPECT_EQ(beliefs.not_replayed(), 1) << "the step after the lost one continues from the log";
}

// A plan with a lost input delays later plans by at most two seconds. Tests one lost input, one
// lost input near the end of the log, and three lost inputs.
TEST_F(ReplayLog, ReproducesPlansAfterALostInput) {
  int plans = 0;
  edited([&](std::string_view channel, Bytes&) {
    plans += channel == "PLAN_Q1" ? 1 : 0;
    return true;
  });
  ASSERT_GE(plans, 7);
  for (const std::vector<int>& without :
       {std::vector{4}, std::vector{plans - 1}, std::vector{2, 4, 6}}) {
    std::vector<std::int64_t> lost;
    int plan = 0;
    edited([&](std::string_view channel, Bytes& data) {
      if (channel == "PLAN_Q1" && std::count(without.begin(), without.end(), ++plan) > 0) {
        const auto made = bus::from_wire(bus::decode_wire<vantage_lcm::plan_t>(data).value());
        for (const models::InputRef& input : made->inputs) {
          if (input.channel == "BELIEF_Q1") {
            lost.push_back(input.sequence);
          }
        }
      }
      return true;
    });
    ASSERT_EQ(lost.size(), without.size());
    const std::string path = edited([&](std::string_view channel, Bytes& data) {
      return channel != "BELIEF_Q1" ||
             std::count(lost.begin(), lost.end(),
                        bus::decode_wire<vantage_lcm::belief_t>(data)->sequence) == 0;
    });
    const ReplayReport report = replay(path, "planner:Q1");
    EXPECT_EQ(report.outputs.different(), 0) << without.back();
    EXPECT_EQ(report.outputs.replayed(), plans - std::ssize(without)) << without.back();
    EXPECT_EQ(report.not_replayed(), std::ssize(without)) << without.back();
  }
}

TEST_F(ReplayLog, RefusesUnknownNodes) {
  const logs::IndexedLog log(trial());
  const scenario::Scenario scenario = tools::scenario_of(log);
  EXPECT_THROW(parse_replay_target("planner", scenario), UsageError);
  EXPECT_THROW(parse_replay_target("sim:Q1", scenario), UsageError);
  EXPECT_THROW(parse_replay_target("planner:Q9", scenario), UsageError);
}

TEST(OutputComparison, IsNotExactWhenNothingWasCompared) {
  EXPECT_FALSE(OutputComparison().is_exact());
}

TEST(OutputComparison, CountsUnreadableOutputsSeparately) {
  const std::vector<std::uint8_t> words{'n', 'o', ' ', 'm', 'e', 's', 's', 'a', 'g', 'e'};
  OutputComparison comparison;
  comparison.add_logged(words);
  comparison.add_replayed(words);
  comparison.add_replayed({});
  EXPECT_EQ(comparison.unreadable(), 3);
  EXPECT_EQ(comparison.logged(), 0);
  EXPECT_EQ(comparison.replayed(), 0);
  EXPECT_EQ(comparison.unexpected(), 0);
  EXPECT_FALSE(comparison.is_exact());
}

TEST(OutputComparison, ComparesOutputsOfTheSameRound) {
  vantage_lcm::plan_t plan{};
  OutputComparison comparison;
  for (const int round : {7, 8}) {
    plan.round = round;
    plan.height_m = 0.25 * round;
    comparison.add_logged(logs::test::encoded(plan));
  }
  plan.round = 7;
  plan.height_m = 1.75;
  comparison.add_replayed(logs::test::encoded(plan));
  EXPECT_TRUE(comparison.is_exact());
  plan.round = 9;
  comparison.add_replayed(logs::test::encoded(plan));
  EXPECT_EQ(comparison.unexpected(), 1);
}

TEST(OutputComparison, DetectsBitDifferencesWithEqualText) {
  vantage_lcm::plan_t plan{};
  plan.robot = "Q1";
  OutputComparison comparison;
  comparison.add_logged(logs::test::encoded(plan));
  plan.run_id = 5;
  plan.sequence = 9;
  comparison.add_replayed(logs::test::encoded(plan));
  EXPECT_TRUE(comparison.is_exact()) << "the publisher does not matter";
  plan.height_m = -0.0;
  comparison.add_replayed(logs::test::encoded(plan));
  EXPECT_EQ(comparison.different(), 1);
  plan.height_m = 0.0;
  plan.utime = 1;
  comparison.add_replayed(logs::test::encoded(plan));
  EXPECT_EQ(comparison.different(), 2) << "the time matters";
}

}  // namespace
}  // namespace vantage::trial
