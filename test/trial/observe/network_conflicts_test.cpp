#include "trial/observe/network_conflicts.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"
#include "core/deadline.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/bus/auth/auth_support.hpp"

namespace vantage::trial {
namespace {

using Channels = std::set<std::string>;

scenario::Scenario lab() { return scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml"); }
scenario::Scenario lab_of_two_hosts() {
  scenario::Scenario scenario = lab();
  scenario.hosts = {{"LAB", {scenario::kSimPart, scenario::kLoggerPart, "Q1"}},
                    {"AIR", {"Q2", "Q3"}}};
  return scenario;
}

TEST(ConflictsWithUp, AreSupervisorsSimulatorsAndVehiclesOfAnotherTrial) {
  const scenario::Scenario scenario = lab();
  EXPECT_TRUE(conflicts_with_up(scenario, "", {}).empty());
  EXPECT_TRUE(conflicts_with_up(scenario, "", Channels{"COMMAND", "VICON", "HEALTH_VIEW"}).empty());
  EXPECT_EQ(conflicts_with_up(scenario, "", Channels{"HOST_LOCAL"}).size(), 1U);
  EXPECT_EQ(conflicts_with_up(scenario, "", Channels{"TRUTH"}).size(), 1U);
  EXPECT_EQ(conflicts_with_up(scenario, "", Channels{"VEHICLE_Q1", "VEHICLE_X"}).size(), 2U);
}

TEST(ConflictsWithUp, AreNotTheOtherHostsOfTheTrial) {
  const scenario::Scenario scenario = lab_of_two_hosts();
  const Channels of_lab{"HOST_LAB", "TRUTH", "VICON", "VEHICLE_Q1", "VEHICLE_Q2"};
  EXPECT_TRUE(conflicts_with_up(scenario, "AIR", of_lab).empty());
  EXPECT_TRUE(conflicts_with_up(scenario, "LAB", Channels{"HOST_AIR", "PLAN_Q2"}).empty());
  EXPECT_EQ(conflicts_with_up(scenario, "LAB", of_lab).size(), 2U)
      << "the same host and its simulator";
  EXPECT_EQ(conflicts_with_up(scenario, "AIR", Channels{"HOST_LOCAL"}).size(), 1U);
  EXPECT_EQ(conflicts_with_up(scenario, "AIR", Channels{"VEHICLE_X"}).size(), 1U);
  EXPECT_EQ(conflicts_with_up(scenario, "", Channels{"HOST_AIR"}).size(), 1U) << "with --all-hosts";
}

TEST(ConflictsWithUp, AreVehiclesThatTheTrialWouldFly) {
  scenario::Scenario scenario = lab_of_two_hosts();
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  EXPECT_EQ(conflicts_with_up(scenario, "AIR", Channels{"VEHICLE_Q1", "VEHICLE_Q2"}).size(), 1U);
}

using Sentences = std::vector<std::string>;

TEST(ConflictsWithUp, AreReportedInOneSentenceEach) {
  const scenario::Scenario scenario = lab_of_two_hosts();
  EXPECT_EQ(conflicts_with_up(scenario, "LAB", Channels{"HOST_LAB"}),
            Sentences{"another `vantage up` runs on this network, as host LAB"});
  EXPECT_EQ(conflicts_with_up(scenario, "LAB", Channels{"HOST_OTHER"}),
            Sentences{"another `vantage up` runs on this network, as host OTHER"});
  EXPECT_EQ(conflicts_with_up(scenario, "LAB", Channels{"TRUTH"}),
            Sentences{"a simulator runs on this network (TRUTH is published)"});
  EXPECT_EQ(conflicts_with_up(scenario, "LAB", Channels{"VEHICLE_X"}),
            Sentences{"vehicle X is alive on this network (VEHICLE_X is published)"});
  EXPECT_TRUE(conflicts_with_up(scenario, "AIR", Channels{"TRUTH"}).empty())
      << "the simulator belongs to LAB";
  EXPECT_TRUE(conflicts_with_up(scenario, "LAB", Channels{"HOST_", "VEHICLE_", "TRUTHS"}).empty());
}

// A direct vehicle belongs to the simulator, whichever host runs its robot. A vehicle with a driver
// belongs to its host.
TEST(ConflictsWithUp, DependOnWhetherSimulatorOrDriverPublishesAVehicle) {
  scenario::Scenario scenario = lab_of_two_hosts();
  scenario.robots[1].device = scenario::DeviceSource::kWire;
  EXPECT_TRUE(conflicts_with_up(scenario, "AIR", Channels{"VEHICLE_Q1", "VEHICLE_Q3"}).empty());
  EXPECT_EQ(conflicts_with_up(scenario, "AIR", Channels{"VEHICLE_Q2"}).size(), 1U);
  EXPECT_TRUE(conflicts_with_up(scenario, "LAB", Channels{"VEHICLE_Q1", "VEHICLE_Q2"}).empty());
  EXPECT_EQ(conflicts_with_up(scenario, "", Channels{"VEHICLE_Q1", "VEHICLE_Q2"}).size(), 2U);
}

TEST(ConflictsWithPlay, AreReportedInOneSentenceEach) {
  EXPECT_EQ(conflicts_with_play(Channels{"HOST_LAB", "TRUTH", "VEHICLE_Q1", "VEHICLE_Q2"}),
            (Sentences{"`vantage up` runs on this network, as host LAB",
                       "a simulator runs on this network", "vehicle Q1 is alive on this network",
                       "vehicle Q2 is alive on this network"}));
  EXPECT_TRUE(conflicts_with_play(Channels{"HOST_", "VEHICLE_", "TRUTHS"}).empty());
}

TEST(ConflictsWithPlay, AreAllLivePublishersOfLoggedChannels) {
  EXPECT_TRUE(conflicts_with_play(Channels{"HEALTH_VIEW", "COMMAND"}).empty());
  EXPECT_EQ(conflicts_with_play(Channels{"VEHICLE_Q1", "HOST_LAB", "TRUTH"}).size(), 3U);
}

TEST(ActiveChannels, ContainThePublishedChannels) {
  bus::InProcessHub hub;
  const auto receiving_end = hub.connect();
  const auto sending_end = hub.connect();
  int checks = 0;
  const auto stop = [&] {
    sending_end->publish("TRUTH", {});
    sending_end->publish("HOST_LAB", {});
    return ++checks > 3;
  };
  EXPECT_EQ(find_active_channels(*receiving_end, std::chrono::hours(1), stop),
            (Channels{"HOST_LAB", "TRUTH"}));
}

TEST(ActiveChannels, ListChannelsWithoutValidSignatureSeparately) {
  bus::InProcessHub hub;
  const bus::VirtualClock clock(from_utime(1'700'000'000'000'000));
  const auto receiving_end = hub.connect();
  const auto sending_end = hub.connect();
  const auto stranger = hub.connect();
  bus::Bus lab(*sending_end, 1);
  lab.secure(test::authenticator(test::keys_of_a_trial()), clock);
  int checks = 0;
  const auto stop = [&] {
    models::HostReport report;
    report.host = "LAB";
    report.stamp.time = clock.now();
    lab.publish(bus::host_channel("LAB"), report);
    for (const char* const channel : {"HOST_X", "VEHICLE_Q9", "TRUTH", "CAMERA"}) {
      stranger->publish(channel, {});
    }
    return ++checks > 3;
  };
  const auto authenticator = test::authenticator(test::keys_of_a_trial());
  const ActiveChannels active =
      find_active_channels(*receiving_end, std::chrono::hours(1), stop, authenticator.get(), clock);
  EXPECT_EQ(active.accepted, (Channels{"HOST_LAB", "CAMERA"}));
  EXPECT_EQ(active.unverified, (Channels{"HOST_X", "VEHICLE_Q9", "TRUTH"}));
}

/// A transport that delivers `channels` one by one per call, then reports its end.
class Recording : public bus::Transport {
 public:
  explicit Recording(int channels) : left_(channels) {}
  void subscribe(const std::string& channel, Handler handler) override {
    EXPECT_EQ(channel, "*");
    handler_ = std::move(handler);
  }
  void unsubscribe(const std::string& /*channel*/) override {}
  bool publish(const std::string& /*channel*/, std::span<const std::uint8_t> /*bytes*/) override {
    ADD_FAILURE() << "a listener must not publish";
    return false;
  }
  int handle(std::chrono::microseconds timeout) override {
    longest_ = std::max(longest_, timeout);
    if (left_ == 0) {
      return bus::kSourceEnded;
    }
    for (int i = 0; i < 1000 && left_ > 0; ++i) {
      handler_("C" + std::to_string(--left_), std::vector<std::uint8_t>{});
    }
    return 1;
  }
  [[nodiscard]] bus::TransportStats stats() const override { return {}; }
  [[nodiscard]] std::chrono::microseconds longest() const { return longest_; }

 private:
  Handler handler_;
  int left_;
  std::chrono::microseconds longest_{};
};

TEST(ActiveChannels, AreLimitedToTenThousandNames) {
  const auto never = [] { return false; };
  for (const int channels : {0, 3, 10'000, 10'001, 12'345}) {
    Recording recording(channels);
    const Channels active = find_active_channels(recording, std::chrono::hours(1), never);
    EXPECT_EQ(active.size(), static_cast<std::size_t>(std::min(channels, 10'000)));
    EXPECT_LE(recording.longest(), std::chrono::milliseconds(50)) << "Ctrl-C is noticed in time";
    EXPECT_GT(recording.longest(), std::chrono::milliseconds(10)) << "the loop does not spin";
  }
  Recording recording(5'000);
  EXPECT_TRUE(find_active_channels(recording, std::chrono::hours(1), [] { return true; }).empty());
}

TEST(ActiveChannels, AreCollectedForTheGivenTime) {
  bus::InProcessHub hub;
  const auto receiving_end = hub.connect();
  // A stop is checked for at intervals of 50 ms: at 0 and 50 ms, and perhaps at 100 ms.
  const std::int64_t begin_ns = monotonic_ns();
  int checks = 0;
  find_active_channels(*receiving_end, std::chrono::milliseconds(75),
                       [&checks] { return ++checks > 9; });
  EXPECT_GE(monotonic_ns() - begin_ns, 75'000'000);
  EXPECT_LE(checks, 3);
  EXPECT_GT(kListenTime, std::chrono::seconds(1)) << "supervisors publish once per second";
  EXPECT_LT(kListenTime, std::chrono::seconds(2)) << "a user waits for it";
}

}  // namespace
}  // namespace vantage::trial
