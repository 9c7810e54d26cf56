#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/auth/authenticator.hpp"
#include "bus/auth/keyring.hpp"
#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "core/check.hpp"
#include "logs/record/log_writer.hpp"
#include "scenario/reader/overrides.hpp"
#include "test/logs/file_support.hpp"
#include "trial/replay/log_replay.hpp"
#include "trial/trial.hpp"

// Replays the log of a short trial, with and without signed messages.

namespace vantage::trial {
namespace {

using bus::auth::Authenticator;
using logs::test::Bytes;
using logs::test::TemporaryFolder;

class SignedReplay : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    scenario::Overrides overrides;
    overrides.seed = 5;
    overrides.duration_s = 4.0;
    overrides.node_budget = 100;
    scenario_ = std::make_unique<scenario::Scenario>(
        scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/lab.yaml", overrides));
    TrialOptions options;
    options.log_path = folder_->file("plain.lcmlog");
    run_trial(*scenario_, trial_recipes(*scenario_), options);
    bus::auth::make_keys(keys());
    sign();
  }
  static void TearDownTestSuite() {
    folder_.reset();
    scenario_.reset();
  }
  static std::string keys() { return folder_->file("keys"); }
  static std::string plain() { return folder_->file("plain.lcmlog"); }
  static std::string with_signatures() { return folder_->file("signed.lcmlog"); }

  /// Signs each event. Inserts a forged, unsigned plan before each plan of Q1, and before each
  /// belief of Q2 a forged belief that is signed for a live trial.
  static void sign() {
    const logs::IndexedLog log(plain());
    logs::LogWriter writer(with_signatures());
    const auto ring = std::make_shared<const bus::auth::Keyring>(bus::auth::load_keyring(keys()));
    Authenticator sender(
        ring, {scenario::SecurityMode::kRequire, scenario::TrialMode::kSimulation, false});
    Authenticator elsewhere(ring,
                            {scenario::SecurityMode::kRequire, scenario::TrialMode::kLive, false});
    logs::LogScan scan = log.scan();
    while (const auto event = scan.next()) {
      if (event->channel == "PLAN_Q1") {
        auto forged = bus::decode_wire<vantage_lcm::plan_t>(event->data).value();
        forged.height_m += 0.5;
        forged.sequence += 1;
        writer.write(event->time, event->channel, logs::test::encoded(forged));
        ++forged_;
      }
      if (event->channel == "BELIEF_Q2") {
        auto forged = bus::decode_wire<vantage_lcm::belief_t>(event->data).value();
        forged.x_world_m += 0.5;
        Bytes bytes = logs::test::encoded(forged);
        elsewhere.seal(event->channel, "", event->time, bytes);
        writer.write(event->time, event->channel, bytes);
        ++forged_;
      }
      Bytes data(event->data.begin(), event->data.end());
      sender.seal(event->channel, "", event->time, data);
      writer.write(event->time, event->channel, data);
      ++events_;
    }
  }

  static ReplayReport replay(const std::string& path, const std::string& node,
                             scenario::SecurityMode mode, const std::string& key_folder) {
    scenario::Scenario scenario = *scenario_;
    scenario.security = {mode, key_folder};
    const logs::IndexedLog log(path);
    return replay_log(log, scenario, parse_replay_target(node, scenario));
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::unique_ptr<scenario::Scenario> scenario_;
  static int forged_;
  static int events_;
};
std::unique_ptr<TemporaryFolder> SignedReplay::folder_;
std::unique_ptr<scenario::Scenario> SignedReplay::scenario_;
int SignedReplay::forged_ = 0;
int SignedReplay::events_ = 0;

TEST_F(SignedReplay, OmitsMessagesThatTheFlightRefused) {
  ASSERT_GE(forged_, 6);
  for (const char* node : {"planner:Q1", "estimator:Q1", "planner:Q2"}) {
    const ReplayReport report =
        replay(with_signatures(), node, scenario::SecurityMode::kRequire, keys());
    EXPECT_TRUE(report.outputs.is_exact()) << node;
    EXPECT_GE(report.outputs.replayed(), 3) << node;
    EXPECT_EQ(report.not_replayed(), 0) << node;
    EXPECT_EQ(report.refused, forged_) << node;
    EXPECT_EQ(report.events, events_) << node;
    EXPECT_FALSE(report.lacks_keys) << node;
  }
}

TEST_F(SignedReplay, AcceptsAllMessagesAndWarnsIfKeysAreMissing) {
  const ReplayReport report = replay(with_signatures(), "planner:Q1",
                                     scenario::SecurityMode::kRequire, folder_->file("nowhere"));
  EXPECT_TRUE(report.lacks_keys);
  EXPECT_EQ(report.refused, 0);
  EXPECT_EQ(report.events, events_ + forged_);
  EXPECT_FALSE(report.outputs.is_exact()) << "forged plans were published, too";
}

TEST_F(SignedReplay, ChecksNothingInUnsignedLogs) {
  for (const std::string& key_folder : {keys(), std::string()}) {
    const ReplayReport report =
        replay(plain(), "planner:Q1", scenario::SecurityMode::kOff, key_folder);
    EXPECT_TRUE(report.outputs.is_exact());
    EXPECT_FALSE(report.lacks_keys);
    EXPECT_EQ(report.refused, 0);
    EXPECT_EQ(report.events, events_);
  }
  const ReplayReport warned = replay(plain(), "planner:Q1", scenario::SecurityMode::kWarn, keys());
  EXPECT_TRUE(warned.outputs.is_exact()) << "unsigned messages are accepted";
  EXPECT_EQ(warned.refused, 0);
  EXPECT_FALSE(warned.lacks_keys);
}

TEST_F(SignedReplay, ReportsProgressEveryThousandEvents) {
  const std::string path = folder_->file("long.lcmlog");
  {
    logs::LogWriter writer(path);
    for (int i = 0; i < 2'500; ++i) {
      writer.write(from_utime(1'000 * i), "NOISE", Bytes(static_cast<std::size_t>(8 + i % 40)));
    }
  }
  const logs::IndexedLog log(path);
  std::vector<double> expected;
  std::int64_t events = 0;
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (++events % 1000 == 0) {
      expected.push_back(static_cast<double>(event->offset) /
                         static_cast<double>(log.bytes().size()));
    }
  }
  expected.push_back(1.0);
  ASSERT_EQ(expected.size(), 3U);
  std::vector<double> shares;
  const ReplayTarget target = parse_replay_target("planner:Q2", *scenario_);
  const ReplayReport report =
      replay_log(log, *scenario_, target, [&](double share) { shares.push_back(share); });
  EXPECT_EQ(shares, expected);
  EXPECT_EQ(report.events, 2'500);
  EXPECT_EQ(report.outputs.logged(), 0);
  EXPECT_FALSE(report.outputs.is_exact()) << "nothing was compared";
}

TEST_F(SignedReplay, ReturnsTheCountersOfTheReplayingNode) {
  const ReplayReport report = replay(plain(), "planner:Q1", scenario::SecurityMode::kOff, "");
  std::map<std::string, std::int64_t> counts;
  for (const models::NamedCount& counter : report.counters) {
    counts[counter.name] = counter.count;
  }
  EXPECT_EQ(counts["replayed_same"], report.outputs.replayed());
  EXPECT_EQ(counts["replayed_different"], 0);
  EXPECT_EQ(counts["replay_inputs_missing"], 0);
}

TEST_F(SignedReplay, ParsesTheNodeToReplay) {
  const ReplayTarget planner = parse_replay_target("planner:Q2", *scenario_);
  EXPECT_EQ(planner.kind, ReplayTarget::Kind::kPlanner);
  EXPECT_EQ(planner.robot, "Q2");
  const ReplayTarget estimator = parse_replay_target("estimator:Q3", *scenario_);
  EXPECT_EQ(estimator.kind, ReplayTarget::Kind::kEstimator);
  EXPECT_EQ(estimator.robot, "Q3");
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_replay_target(text, *scenario_));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "taken";
  };
  for (const std::string none : {"planner", "estimator", "Q1", "", ":Q1", "sim:Q1", "planner Q1"}) {
    EXPECT_EQ(refusal(none),
              "node '" + none + "': must be planner:ROBOT, estimator:ROBOT or localizer:ROBOT");
  }
  for (const std::string none : {"planner:", "planner:Q9", "estimator:planner:Q1"}) {
    EXPECT_EQ(refusal(none), "node '" + none + "': the log has no such robot");
  }
}

}  // namespace
}  // namespace vantage::trial
