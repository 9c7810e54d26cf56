#include "trial/trial.hpp"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <sys/resource.h>

#include "bus/convert/convert.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"
#include "test/support/temporary_folder.hpp"
#include "trial/robot_processes.hpp"

namespace vantage::trial {
namespace {

scenario::Scenario short_lab(std::uint64_t seed) {
  scenario::Overrides overrides;
  overrides.seed = seed;
  overrides.duration_s = 6.0;
  overrides.node_budget = 200;
  return scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/lab.yaml", overrides);
}

std::string trial_json(std::uint64_t seed) {
  const scenario::Scenario scenario = short_lab(seed);
  return logs::to_json(run_trial(scenario, trial_recipes(scenario)).summary).dump();
}

TEST(RunTrial, IsAPureFunctionOfTheSeed) {
  const std::string first = trial_json(3);
  EXPECT_EQ(first, trial_json(3));
  EXPECT_NE(first, trial_json(4));
}

TEST(TrialRecipes, HaveTheNamesOfTheirNodes) {
  const scenario::Scenario scenario = short_lab(3);
  const std::vector<NodeRecipe> recipes = trial_recipes(scenario);
  EXPECT_EQ(recipes.size(), 1 + kRobotProcesses.size() * scenario.robots.size());
  bus::InProcessHub hub;
  const bus::VirtualClock clock(Time{});
  for (const NodeRecipe& recipe : recipes) {
    const auto transport = hub.connect();
    bus::Bus bus(*transport, 1);
    EXPECT_EQ(recipe.make(bus, clock)->name(), recipe.name);
  }
}

struct ExternalRow {
  const char* was;
  const char* becomes;
  std::vector<std::string> own;  ///< processes of each robot that vantage runs
};

// `device: external` in a section: a process of the user replaces that process of vantage.
TEST(TrialRecipes, LeaveOutExternalProcesses) {
  for (const ExternalRow& row :
       {ExternalRow{
            "kind: range_bearing", "kind: range_bearing", {"sensor", "estimator", "planner"}},
        ExternalRow{"kind: range_bearing",
                    "device: external\n    kind: range_bearing",
                    {"estimator", "planner"}},
        ExternalRow{"\nestimator:\n", "\nestimator:\n  device: external\n", {"sensor", "planner"}},
        ExternalRow{"\nplanner:\n", "\nplanner:\n  device: external\n", {"sensor", "estimator"}},
        ExternalRow{"\nplanner:\n",
                    "\nplanner:\n  device: vantage\n",
                    {"sensor", "estimator", "planner"}}}) {
    const scenario::Scenario scenario =
        scenario::parse_scenario(test::lab_with({{row.was, row.becomes}}), "f");
    for (const scenario::RobotSpec& robot : scenario.robots) {
      EXPECT_EQ(own_processes(scenario, robot), row.own) << row.becomes;
    }
    EXPECT_EQ(trial_recipes(scenario).size(), 1 + row.own.size() * scenario.robots.size());
    if (row.own.size() == kRobotProcesses.size()) {
      require_own_processes(scenario);
    } else {
      EXPECT_THROW(require_own_processes(scenario), StartupError);
    }
  }
}

TEST(TrialRecipes, BeginWithTheLocalizersOfTheScenario) {
  const scenario::Scenario scenario =
      scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab-nomocap.yaml");
  const std::vector<std::string> own{"localizer", "sensor", "estimator", "planner"};
  for (const scenario::RobotSpec& robot : scenario.robots) {
    EXPECT_EQ(own_processes(scenario, robot), own);
  }
  const std::vector<NodeRecipe> recipes = trial_recipes(scenario);
  ASSERT_EQ(recipes.size(), 1 + own.size() * scenario.robots.size());
  EXPECT_EQ(recipes[1].name, "LOCALIZER_Q1");
}

TEST(RunTrial, WritesEqualLogsForEqualSeeds) {
  const scenario::Scenario scenario = short_lab(6);
  const test::TemporaryFolder folder;
  std::string logs[2];
  for (std::string& log : logs) {
    TrialOptions options;
    options.log_path = folder.file("trial.lcmlog");
    std::filesystem::remove(options.log_path);
    run_trial(scenario, trial_recipes(scenario), options);
    std::ifstream file(options.log_path, std::ios::binary);
    log.assign(std::istreambuf_iterator<char>(file), {});
  }
  EXPECT_GT(logs[0].size(), 100'000U);
  EXPECT_TRUE(logs[0] == logs[1]);  // run ids, sequences and times included
}

TEST(Trial, IsIndependentOfTheStepLength) {
  const scenario::Scenario scenario = short_lab(6);
  const test::TemporaryFolder folder;
  const std::string path = folder.file("trial.lcmlog");
  std::string logs[2];
  std::string summaries[2];
  for (const bool is_whole : {true, false}) {
    std::filesystem::remove(path);
    {
      Trial trial(scenario, trial_recipes(scenario), path);
      std::int64_t piece_us = is_whole ? 60'000'000 : 1'000;
      while (trial.time() < trial.planned_end()) {
        trial.advance_to(trial.time() + Duration{piece_us});
        piece_us = 1 + piece_us * 7 / 3 % 1'000'003;
        static_cast<void>(trial.result());  // a query has no side effect
      }
      EXPECT_EQ(trial.time(), trial.planned_end());
      summaries[is_whole ? 0 : 1] = logs::to_json(trial.result().summary).dump();
    }
    std::ifstream file(path, std::ios::binary);
    logs[is_whole ? 0 : 1].assign(std::istreambuf_iterator<char>(file), {});
  }
  EXPECT_GT(logs[0].size(), 100'000U);
  EXPECT_TRUE(logs[0] == logs[1]);
  EXPECT_EQ(summaries[0], summaries[1]);
}

TEST(RunTrial, PlansEveryRoundWithoutLoss) {
  const scenario::Scenario scenario = short_lab(1);
  const TrialResult result = run_trial(scenario, trial_recipes(scenario));
  EXPECT_GE(result.summary.rounds, 5);  // rounds of 1 s
  EXPECT_EQ(result.summary.plans_missing, 0);
  EXPECT_EQ(result.summary.messages_lost, 0);
  EXPECT_EQ(result.summary.duration_s, 6.0);
  EXPECT_EQ(result.summary.collisions, 0);
  EXPECT_EQ(result.summary.discovery_time_s.size(), 5U);
  EXPECT_TRUE(result.summary.min_separation_m);
  for (const auto& [name, robot] : result.scene.robots) {
    EXPECT_TRUE(robot.plan) << name;
    EXPECT_TRUE(robot.world_from_body) << name;
  }
}

TEST(RunTrial, StoppedEarlyEqualsAShorterTrial) {
  scenario::Scenario scenario = short_lab(2);
  TrialOptions options;
  int checks = 0;
  options.stop = [&checks] { return ++checks == 3; };
  const TrialResult stopped = run_trial(scenario, trial_recipes(scenario), options);
  EXPECT_TRUE(stopped.was_stopped);
  ASSERT_GT(stopped.summary.duration_s, 0.0);
  ASSERT_LT(stopped.summary.duration_s, scenario.duration_s);
  scenario.duration_s = stopped.summary.duration_s;
  const TrialResult shorter = run_trial(scenario, trial_recipes(scenario));
  EXPECT_FALSE(shorter.was_stopped);
  EXPECT_EQ(logs::to_json(stopped.summary).dump(), logs::to_json(shorter.summary).dump());
}

TEST(RunTrial, ReportsProgress) {
  const scenario::Scenario scenario = short_lab(5);
  std::vector<double> shares;
  TrialOptions options;
  options.progress = [&](double share) { shares.push_back(share); };
  run_trial(scenario, trial_recipes(scenario), options);
  ASSERT_GT(shares.size(), 5U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_LT(shares.front(), 0.2);
  EXPECT_NEAR(shares.back(), 1.0, 1e-9);
}

// Without nodes nothing has to be computed, so three hours of virtual time pass immediately.
TEST(RunTrial, ReportsProgressAHundredTimes) {
  scenario::Scenario scenario = short_lab(5);
  for (const double duration_s : {300.0, 10'800.0}) {
    scenario.duration_s = duration_s;
    std::vector<double> shares;
    int checks = 0;
    TrialOptions options;
    options.progress = [&](double share) { shares.push_back(share); };
    options.stop = [&checks] {
      ++checks;
      return false;
    };
    const TrialResult result = run_trial(scenario, {}, options);
    ASSERT_EQ(shares.size(), 100U) << duration_s;
    for (std::size_t i = 0; i < 100; ++i) {
      EXPECT_NEAR(shares[i], 0.01 * static_cast<double>(i + 1), 0.5 / duration_s + 1e-9);
    }
    EXPECT_EQ(checks, static_cast<int>(2.0 * duration_s) - 1)
        << "every half second except at the end";
    EXPECT_FALSE(result.was_stopped);
    EXPECT_EQ(result.summary.duration_s, duration_s);
  }
}

TEST(RunTrial, EndsAtTheNextHalfSecondAfterAStop) {
  scenario::Scenario scenario = short_lab(5);
  for (const int at : {1, 2, 7}) {
    TrialOptions options;
    int checks = 0;
    options.stop = [&] { return ++checks >= at; };
    const TrialResult result = run_trial(scenario, {}, options);
    EXPECT_EQ(result.summary.duration_s, 0.5 * at);
    EXPECT_EQ(checks, at) << "no further query";
    EXPECT_TRUE(result.was_stopped);
  }
}

TEST(Trial, RefusesTimesInThePastOrBeyondItsEnd) {
  const scenario::Scenario scenario = short_lab(5);
  Trial trial(scenario, {}, "");
  EXPECT_EQ(trial.start(), trial_start(scenario));
  EXPECT_EQ(trial.time(), trial.start());
  EXPECT_EQ(trial.planned_end(), trial.start() + std::chrono::seconds(6));
  EXPECT_FALSE(trial.is_log_lost());
  EXPECT_EQ(trial.result().summary.duration_s, 0.0);
  trial.advance_to(trial.start() + std::chrono::milliseconds(1'500));
  EXPECT_EQ(trial.result().summary.duration_s, 1.5);
  EXPECT_TRUE(trial.result().was_stopped);
  trial.advance_to(trial.start() + std::chrono::seconds(1));
  EXPECT_EQ(trial.time(), trial.start() + std::chrono::milliseconds(1'500));
  trial.advance_to(trial.start() + std::chrono::hours(1));
  EXPECT_EQ(trial.time(), trial.planned_end());
  EXPECT_FALSE(trial.result().was_stopped);
}

TEST(RunTrial, RefusesExternalPlanners) {
  scenario::Scenario scenario = short_lab(5);
  scenario.planner.algorithm = "external";
  EXPECT_THROW(run_trial(scenario, {}), StartupError);
  const test::TemporaryFolder folder;
  TrialOptions options;
  options.log_path = folder.file("there.lcmlog");
  std::ofstream(options.log_path) << "a log of before";
  EXPECT_THROW(run_trial(short_lab(5), {}, options), StartupError);
}

// A limit on the file size simulates a full disk.
TEST(RunTrial, EndsOnALogErrorAndCountsLostEvents) {
  const scenario::Scenario scenario = short_lab(5);
  const test::TemporaryFolder folder;
  TrialOptions options;
  options.log_path = folder.file("full.lcmlog");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{400'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const TrialResult result = run_trial(scenario, trial_recipes(scenario), options);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_TRUE(result.was_stopped);
  ASSERT_TRUE(result.log_error);
  EXPECT_GT(result.summary.duration_s, 0.0);
  EXPECT_LT(result.summary.duration_s, 6.0);

  scenario::Scenario shorter = scenario;
  shorter.duration_s = result.summary.duration_s;
  TrialOptions whole;
  whole.log_path = folder.file("whole.lcmlog");
  EXPECT_FALSE(run_trial(shorter, trial_recipes(shorter), whole).log_error);
  const auto events = [](const std::string& path) {
    lcm::LogFile log(path, "r");
    std::int64_t count = 0;
    while (log.readNextEvent() != nullptr) {
      ++count;
    }
    return count;
  };
  EXPECT_EQ(result.summary.messages_lost, events(whole.log_path) - events(options.log_path));
  EXPECT_GT(result.summary.messages_lost, 0);
}

/// Publishes at its first instant more messages than a queue can contain, and subscribes to them.
class Talker : public bus::Node {
 public:
  explicit Talker(bus::Bus& bus) : bus_(bus) {
    bus_.subscribe<models::AttackNotice>(kTalk, [](const models::AttackNotice& /*heard*/) {});
  }
  [[nodiscard]] std::string name() const override { return "TALKER"; }
  [[nodiscard]] Time next_tick() const override { return next_; }
  void tick(Time now) override {
    for (int i = 0; i < 10'050; ++i) {
      models::AttackNotice notice;
      notice.stamp.time = now;
      bus_.publish(kTalk, notice);
    }
    next_ = now + std::chrono::hours(1);
  }

 private:
  inline static const bus::Channel<models::AttackNotice> kTalk{"TALK"};
  bus::Bus& bus_;
  Time next_{};
};

// A queue keeps the last ten thousand of 10 050 messages. The trial's queue loses 50. The
// recorder's queue also receives the talker's health, so it loses 51.
TEST(RunTrial, CountsEventsDroppedByTheRecorder) {
  scenario::Scenario scenario = short_lab(5);
  scenario.duration_s = 1.0;
  const std::vector<NodeRecipe> recipes = {
      {"TALKER", [](bus::Bus& bus, const bus::Clock&) { return std::make_unique<Talker>(bus); }}};
  EXPECT_EQ(run_trial(scenario, recipes).summary.messages_lost, 50);
  const test::TemporaryFolder folder;
  TrialOptions options;
  options.log_path = folder.file("talk.lcmlog");
  EXPECT_EQ(run_trial(scenario, recipes, options).summary.messages_lost, 50 + 51);
}

TEST(RunTrial, RefusesATimeBudgetInVirtualTime) {
  scenario::Scenario scenario = short_lab(1);
  scenario.planner.node_budget = 0;
  EXPECT_THROW(run_trial(scenario, {}), UsageError);
}

TEST(RunTrial, StartsAtTheBeginningOfARound) {
  scenario::Scenario scenario = short_lab(1);
  scenario.planner.step_s = 0.7;
  scenario.planner.execute_steps = 3;
  const std::int64_t start = to_utime(trial_start(scenario));
  EXPECT_GE(start, 1'700'000'000'000'000);
  EXPECT_LT(start, 1'700'000'000'000'000 + 2'100'000);
  EXPECT_EQ(start % 2'100'000, 0);
  // A round begins exactly at 1 700 000 000 s, so the trial starts at this time.
  scenario.planner.step_s = 0.5;
  scenario.planner.execute_steps = 2;
  EXPECT_EQ(to_utime(trial_start(scenario)), 1'700'000'000'000'000);
  // 1 699 999 999 999 999 µs is a multiple of 157 µs, so the first round after 1 700 000 000 s
  // begins 156 µs later.
  scenario.planner.step_s = 157e-6;
  scenario.planner.execute_steps = 1;
  EXPECT_EQ(to_utime(trial_start(scenario)), 1'700'000'000'000'156);
}

TEST(RunTrial, LogsTheScenarioFirst) {
  const scenario::Scenario scenario = short_lab(5);
  const test::TemporaryFolder folder;
  TrialOptions options;
  options.log_path = folder.file("trial.lcmlog");
  run_trial(scenario, trial_recipes(scenario), options);

  lcm::LogFile log(options.log_path, "r");
  ASSERT_TRUE(log.good());
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->channel, "SCENARIO");
  EXPECT_EQ(event->timestamp, to_utime(trial_start(scenario)));
  vantage_lcm::scenario_t wire{};
  ASSERT_GT(wire.decode(event->data, 0, event->datalen), 0);
  EXPECT_EQ(scenario::parse_scenario(wire.yaml, "log").seed, 5U);

  std::map<std::string, int> events;
  std::int64_t newest = event->timestamp;
  while ((event = log.readNextEvent()) != nullptr) {
    EXPECT_GE(event->timestamp, newest);
    newest = event->timestamp;
    ++events[event->channel];
  }
  for (const std::string channel : {"VICON", "TRUTH", "MEASUREMENT_Q1", "BELIEF_Q2", "PLAN_Q3",
                                    "VEHICLE_Q1", "HEALTH_SIM", "HEALTH_PLANNER_Q1"}) {
    EXPECT_GT(events[channel], 0) << channel;
  }
  EXPECT_EQ(events["SCENARIO"], 1) << "a second time after 5 s";
}

TEST(TrialRecipes, ListTheSimulatorThenNodesByKind) {
  const scenario::Scenario scenario = short_lab(3);
  std::vector<std::string> names;
  for (const NodeRecipe& recipe : trial_recipes(scenario)) {
    names.push_back(recipe.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"SIM", "SENSOR_Q1", "SENSOR_Q2", "SENSOR_Q3",
                                             "ESTIMATOR_Q1", "ESTIMATOR_Q2", "ESTIMATOR_Q3",
                                             "PLANNER_Q1", "PLANNER_Q2", "PLANNER_Q3"}));
  EXPECT_EQ(process_name("planner", "Q1"), "planner Q1");
  EXPECT_EQ(node_name("a bc D9"), "A_BC_D9");
}

}  // namespace
}  // namespace vantage::trial
