#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "sim/autopilot/endpoint.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"
#include "test/drivers/vehicle/vehicle_node_bench.hpp"
#include "test/support/udp_port.hpp"

// A flying vehicle with its node and a real bus, for tests that check which sources are trusted.

namespace vantage::test {

using drivers::QuadrotorNode;
using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;

inline constexpr std::int64_t kLabRun = 22;  // run id of mocap and operator on the bench
inline constexpr std::int64_t kOtherRun = 5;
inline constexpr const char* kSecondSource = "messages from a second VICON source are rejected";
inline constexpr const char* kOtherClock =
    "VICON messages from another clock or a log are rejected";
inline constexpr std::int64_t kFarAhead = std::int64_t{1} << 62;

struct FlightNodeBench : VehicleNodeBench<QuadrotorNode, sim::AutopilotEndpoint> {
  explicit FlightNodeBench(const std::string& url)
      : VehicleNodeBench(FlightBench::scenario_for(AutopilotDialect::kPx4),
                         FlightBench::vehicle_for(AutopilotDialect::kPx4), url, FlightBench::kStart,
                         [](const sim::AutopilotEndpoint& quadrotor) {
                           return quadrotor.emulator().world_from_body();
                         }) {}
  [[nodiscard]] double height_m() const {
    return vehicle.emulator().world_from_body().translation_m.z();
  }
  [[nodiscard]] FlightState state() const {
    return statuses.empty() ? FlightState::kIdle : statuses.back().state;
  }
  [[nodiscard]] bool has_reason(const std::string& reason) const {
    const auto& reasons = statuses.back().reasons;
    return std::find(reasons.begin(), reasons.end(), reason) != reasons.end();
  }
  [[nodiscard]] std::int64_t count(const std::string& name) const {
    std::int64_t out = 0;
    for (const models::NamedCount& counter : node.counters()) {
      out += counter.name == name ? counter.count : 0;
    }
    for (const models::NamedCount& counter : node_bus.counters()) {
      out += counter.name == name ? counter.count : 0;
    }
    return out;
  }
};

class VehicleTrust : public ::testing::Test {
 protected:
  void stand() {
    ASSERT_TRUE(bench.run_until(
        [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0));
  }
  void take_off() {
    stand();
    bench.send_command(OperatorAction::kArm);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.vehicle.emulator().controller().is_armed(); }, 40.0));
    bench.run(1.5);
    bench.send_command(OperatorAction::kTakeOff);
    ASSERT_TRUE(bench.run_until([&] { return bench.height_m() > 0.9; }, 15.0));
    bench.run(3.0);
    bench.statuses.clear();
    bench.run(0.2);
    ASSERT_EQ(bench.state(), FlightState::kHold);
    hovering_ = bench.statuses.back().reasons;
  }
  models::OperatorCommand command(OperatorAction action, std::int64_t run, std::int64_t sequence,
                                  Duration age) const {
    models::OperatorCommand out;
    out.stamp = {bench.clock.now() - age, run, sequence};
    out.action = action;
    return out;
  }
  /// True if the vehicle has reported only its normal hover since take_off().
  [[nodiscard]] testing::AssertionResult only_hovered() const {
    for (models::VehicleStatus status : bench.statuses) {
      std::erase(status.reasons, kSecondSource);
      std::erase(status.reasons, kOtherClock);
      if (status.state != FlightState::kHold || status.reasons != hovering_) {
        return testing::AssertionFailure() << name_of(status.state) << words_of(status.reasons)
                                           << ", not hold" << words_of(hovering_);
      }
    }
    return testing::AssertionSuccess();
  }
  [[nodiscard]] bool hovers() const {
    return bench.state() == FlightState::kHold && bench.statuses.back().reasons == hovering_;
  }
  static std::string words_of(const std::vector<std::string>& reasons) {
    std::string out;
    for (const std::string& reason : reasons) {
      out += ", " + reason;
    }
    return out;
  }

  /// Starts a second mocap source that shows the vehicle at another position, until each_step is
  /// replaced.
  void begin_second_mocap() {
    second_side_ = bench.hub.connect();
    second_ = std::make_unique<bus::Bus>(*second_side_, kOtherRun);
    bench.each_step = [this] {
      if (bench.steps % 2 == 1) {
        models::MocapFrame frame = bench.see();
        frame.bodies[0].world_from_body.translation_m = {-1.0, 1.0, 0.05};
        second_->publish(bus::kVicon, frame);
      }
    };
  }

  FlightNodeBench bench{"udp://127.0.0.1:" + port_of_this_test(0)};
  std::vector<std::string> hovering_;  ///< reasons reported in a normal hover
  std::unique_ptr<bus::Transport> second_side_;
  std::unique_ptr<bus::Bus> second_;
};

}  // namespace vantage::test
