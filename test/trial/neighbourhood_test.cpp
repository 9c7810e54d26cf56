#include <algorithm>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/logs/file_support.hpp"
#include "trial/replay/log_replay.hpp"
#include "trial/trial.hpp"

// Tests teams in which no robot subscribes to all others.

namespace vantage::trial {
namespace {

constexpr double kNeighbourhood_m = 36.0;

/// Returns a scenario of 4 s with robots 16 m apart in rows of 13, and the same number of targets.
scenario::Scenario crowd(int robots, const std::string& of_planner) {
  const int rows = (robots + 12) / 13;
  std::string text = fmt::format(
      "name: crowd\nduration_s: 4\n"
      "world: {{bounds: {{min_m: [-8, -8], max_m: [200, {}]}}, ceiling_m: 30}}\n"
      "robot_defaults:\n  primitives: standard\n"
      "  limits: {{speed_max_mps: 3, yaw_rate_max_radps: 3, brake_mps2: 4, radius_m: 0.25}}\n"
      "  sensor: {{kind: range_bearing, range_max_m: 8, range_min_m: 0.1, fov_deg: 94}}\n"
      "targets: {{count: {}}}\nestimator: {{grid_resolution_m: 2}}\n"
      "planner: {{algorithm: arvi, horizon_steps: 6, step_s: 0.5, execute_steps: 2, "
      "team_budget_s: 0.5, node_budget: 200{}}}\n"
      "network: {{communication_range_m: 20, neighbourhood_m: {}}}\nrobots:\n",
      16 * rows - 8, robots, of_planner, kNeighbourhood_m);
  for (int i = 0; i < robots; ++i) {
    text += fmt::format("  - {{name: Q{}, start: {{x_m: {}, y_m: {}}}, height_m: {}}}\n", i + 1,
                        16 * (i % 13), 16 * (i / 13), 1 + i % 3);
  }
  return scenario::parse_scenario(text, "crowd.yaml");
}

/// Statistics of the messages published in a trial.
struct TrialMessages {
  std::size_t most_inputs = 0;
  double farthest_target_m = 0.0;
  std::size_t most_cells = 0;
  std::size_t searched = 0;
  std::map<std::int64_t, std::set<Time>> slots;  ///< start times, by round
};

template <class Message, class Wire>
Message decoded(std::span<const std::uint8_t> bytes) {
  return *bus::from_wire(*bus::decode_wire<Wire>(bytes));
}

TrialMessages trial_messages(const logs::IndexedLog& log) {
  TrialMessages messages;
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (event->channel.starts_with("BELIEF_")) {
      const auto belief = decoded<models::RobotBelief, vantage_lcm::belief_t>(event->data);
      messages.most_inputs = std::max(messages.most_inputs, belief.inputs.size());
      messages.most_cells = std::max(messages.most_cells, belief.last_seen_utime.size());
      for (const models::TargetBelief& target : belief.targets) {
        const auto gaussian = models::to_gaussian(target.information);
        messages.farthest_target_m = std::max(
            messages.farthest_target_m,
            (gaussian->mean.head<2>() - belief.viewpoint.world_from_body.position_m()).norm());
      }
    } else if (event->channel.starts_with("PLAN_")) {
      const auto plan = decoded<models::RobotPlan, vantage_lcm::plan_t>(event->data);
      messages.most_inputs = std::max(messages.most_inputs, plan.inputs.size());
      messages.searched += plan.source == models::PlanSource::kSearched ? 1 : 0;
      messages.slots[plan.round].insert(plan.slot_start);
    }
  }
  return messages;
}

class Neighbourhood : public ::testing::TestWithParam<std::string> {};

TEST_P(Neighbourhood, LimitsMessagesAndReplaysExactly) {
  const logs::test::TemporaryFolder folder;
  const scenario::Scenario scenario = crowd(65, GetParam());
  TrialOptions options;
  options.log_path = folder.file("crowd.lcmlog");
  const TrialResult result = run_trial(scenario, trial_recipes(scenario), options);
  EXPECT_EQ(result.summary.collisions, 0);
  EXPECT_EQ(result.summary.separation_violations, 0);
  EXPECT_EQ(result.summary.messages_lost, 0);
  EXPECT_EQ(result.summary.plans_missing, 0);
  EXPECT_GT(result.summary.discovered, 10);

  const logs::IndexedLog log(options.log_path);
  const TrialMessages messages = trial_messages(log);
  EXPECT_LE(messages.most_inputs, 60U)
      << "a plan and a status of each of about 20 robots, and a few others";
  EXPECT_LE(messages.farthest_target_m, kNeighbourhood_m);
  EXPECT_LE(messages.most_cells, 48U * 48U) << "2.5 neighbourhoods in cells of 2 m";
  EXPECT_GE(messages.searched, 100U);
  for (const auto& [round, slots] : messages.slots) {
    EXPECT_LE(slots.size(), GetParam().empty() ? 65U : 32U);
  }
  for (const char* node : {"planner:Q1", "planner:Q33", "estimator:Q33", "estimator:Q65"}) {
    const ReplayReport report = replay_log(log, scenario, parse_replay_target(node, scenario));
    EXPECT_TRUE(report.outputs.is_exact()) << node;
    EXPECT_GE(report.outputs.replayed(), 3) << node;
    EXPECT_EQ(report.not_replayed(), 0) << node;
  }
}

INSTANTIATE_TEST_SUITE_P(Slots, Neighbourhood, ::testing::Values("", ", slots: 32"),
                         [](const auto& kind) {
                           return kind.param.empty() ? "OnePerRobot" : "Shared";
                         });

}  // namespace
}  // namespace vantage::trial
