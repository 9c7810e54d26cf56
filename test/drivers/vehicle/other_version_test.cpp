// Tests a vehicle node on a bus on which a program of another software version publishes.

#include <algorithm>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "sim/autopilot/endpoint.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"
#include "test/drivers/vehicle/vehicle_node_bench.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;
using test::FlightBench;

constexpr const char* kReason = "another version";

class OtherVersion : public ::testing::Test {
 protected:
  [[nodiscard]] bool reports_other_version() const {
    const auto& reasons = bench_.statuses.back().reasons;
    return std::find(reasons.begin(), reasons.end(), kReason) != reasons.end();
  }
  [[nodiscard]] bool is_armed() const { return bench_.vehicle.emulator().controller().is_armed(); }
  void stand() {
    ASSERT_TRUE(bench_.run_until(
        [&] { return !bench_.statuses.empty() && bench_.statuses.back().reasons.empty(); }, 20.0));
  }
  /// Publishes a plan of another software version; its message type has another hash.
  void publish_other_version() {
    bench_.attacker->publish("PLAN_Q9", std::vector<std::uint8_t>(64, 7));
  }

  test::VehicleNodeBench<QuadrotorNode, sim::AutopilotEndpoint> bench_{
      FlightBench::scenario_for(models::AutopilotDialect::kPx4),
      FlightBench::vehicle_for(models::AutopilotDialect::kPx4),
      "udp://127.0.0.1:" + test::port_of_this_test(0), FlightBench::kStart,
      [](const sim::AutopilotEndpoint& quadrotor) {
        return quadrotor.emulator().world_from_body();
      }};
};

TEST_F(OtherVersion, ForbidsArmingUntilItIsSilent) {
  stand();
  publish_other_version();
  bench_.run(0.5);
  EXPECT_TRUE(reports_other_version());
  bench_.send_command(OperatorAction::kArm);
  bench_.run(3.0);
  EXPECT_FALSE(is_armed());
  bench_.run(3.0);
  EXPECT_FALSE(reports_other_version());
  bench_.send_command(OperatorAction::kArm);
  EXPECT_TRUE(bench_.run_until([&] { return is_armed(); }, 40.0));
}

TEST_F(OtherVersion, IsReportedButNotRefusedInFlight) {
  stand();
  bench_.send_command(OperatorAction::kArm);
  ASSERT_TRUE(bench_.run_until([&] { return is_armed(); }, 40.0));
  bench_.run(1.5);
  bench_.send_command(OperatorAction::kTakeOff);
  ASSERT_TRUE(bench_.run_until(
      [&] { return bench_.vehicle.emulator().world_from_body().translation_m.z() > 0.9; }, 15.0));
  bench_.run(3.0);
  bench_.each_step = [&] { publish_other_version(); };
  bench_.statuses.clear();
  bench_.run(2.0);
  EXPECT_TRUE(reports_other_version());
  for (const models::VehicleStatus& status : bench_.statuses) {
    EXPECT_EQ(status.state, models::FlightState::kHold);
  }
}

}  // namespace
}  // namespace vantage::drivers
