// Tests the check of a vehicle's parameters on the ground, with both emulated autopilots.

#include "tools/check/vehicle_check.hpp"

#include <gtest/gtest.h>

#include "sim/autopilot/autopilot_emulator.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::tools {
namespace {

using models::AutopilotDialect;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

struct Bench {
  explicit Bench(AutopilotDialect autopilot, AutopilotDialect expected)
      : vehicle(vehicle_for(autopilot), kStart), check(robot_for(expected), std::nullopt, kStart) {}
  explicit Bench(AutopilotDialect dialect) : Bench(dialect, dialect) {}

  static sim::AutopilotEmulatorSpec vehicle_for(AutopilotDialect dialect) {
    sim::AutopilotEmulatorSpec out;
    out.dialect = dialect;
    return out;
  }
  static scenario::RobotSpec robot_for(AutopilotDialect dialect) {
    scenario::RobotSpec out = test::lab_scenario().robots[0];
    out.autopilot =
        scenario::AutopilotSpec{dialect, "udp://:1", 1, "", scenario::ParameterPolicy::kIgnore};
    return out;
  }
  /// Runs until the check has ended, for at most `seconds`.
  bool run(double seconds) {
    const Time end = now + from_seconds(seconds);
    for (; now < end && !check.is_done(now); now += Duration{5'000}) {
      step();
    }
    return check.is_done(now);
  }
  void step() {
    vehicle.advance_to(now);
    for (const auto& datagram : vehicle.take_output()) {
      if (!is_wire_cut) {
        check.receive(datagram, true, now);
      }
    }
    check.tick(now);
    for (const auto& datagram : check.take_output()) {
      if (!is_wire_cut) {
        vehicle.receive(datagram, now);
      }
    }
  }
  std::string description() const {
    std::string out;
    for (const std::string& line : describe(check, now)) {
      out += line + "\n";
    }
    return out;
  }

  sim::AutopilotEmulator vehicle;
  VehicleCheck check;
  Time now = kStart;
  bool is_wire_cut = false;
};

class CheckVehicles : public ::testing::TestWithParam<AutopilotDialect> {
 protected:
  Bench bench{GetParam()};
  std::string loss_name() const {
    return GetParam() == AutopilotDialect::kPx4 ? "COM_OF_LOSS_T" : "GUID_TIMEOUT";
  }
};
INSTANTIATE_TEST_SUITE_P(Dialects, CheckVehicles,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST_P(CheckVehicles, AcceptsACorrectlyConfiguredVehicle) {
  ASSERT_TRUE(bench.run(20.0));
  EXPECT_TRUE(bench.check.is_ready(bench.now));
  EXPECT_NE(bench.description().find("parameters have the required values"), std::string::npos);
}

TEST_P(CheckVehicles, ReportsEachDifferenceAndItsConsequence) {
  bench.vehicle.set_parameter(loss_name(), 3.0);
  ASSERT_TRUE(bench.run(20.0));
  EXPECT_FALSE(bench.check.is_ready(bench.now));
  ASSERT_EQ(bench.check.differences().size(), 1U);
  EXPECT_NE(bench.description().find(loss_name()), std::string::npos);
  EXPECT_NE(bench.description().find("it flies on for this time after the driver dies"),
            std::string::npos);
  EXPECT_EQ(bench.vehicle.parameter(loss_name()), 3.0) << "nothing is written without a request";
}

TEST_P(CheckVehicles, WritesDifferencesAndReadsThemBack) {
  for (const wire::ParameterRule& rule : wire::parameter_rules(GetParam())) {
    bench.vehicle.set_parameter(rule.name, 77.0);
  }
  ASSERT_TRUE(bench.run(20.0));
  ASSERT_FALSE(bench.check.is_ready(bench.now));
  bench.check.load();
  ASSERT_TRUE(bench.run(20.0));
  EXPECT_TRUE(bench.check.is_ready(bench.now)) << bench.description();
  for (const wire::ParameterRule& rule : wire::parameter_rules(GetParam())) {
    EXPECT_TRUE(rule.accepts(bench.vehicle.parameter(rule.name).value_or(-1.0))) << rule.name;
  }
}

TEST_P(CheckVehicles, WritesNothingToAnArmedVehicle) {
  bench.vehicle.set_parameter(loss_name(), 3.0);
  ASSERT_TRUE(bench.run(20.0));
  ASSERT_EQ(bench.check.differences().size(), 1U);
  bench.vehicle.controller().set_origin();
  const Time end = bench.now + from_seconds(40.0);
  // Sends the vehicle its own poses, so that it arms.
  for (; bench.now < end && !bench.vehicle.controller().is_armed(); bench.now += Duration{5'000}) {
    bench.vehicle.controller().take_pose(bench.now, bench.now, {0.0, 0.0, 0.0}, 0);
    static_cast<void>(bench.vehicle.controller().arm(bench.now));
    bench.step();
  }
  ASSERT_TRUE(bench.vehicle.controller().is_armed());
  const Time soon = bench.now + from_seconds(1.5);  // a heartbeat reports it as armed by then
  for (; bench.now < soon; bench.now += Duration{5'000}) {
    bench.step();
  }
  bench.check.load();
  for (const Time later = bench.now + from_seconds(3.0); bench.now < later;
       bench.now += Duration{5'000}) {
    bench.step();
  }
  EXPECT_EQ(bench.vehicle.parameter(loss_name()), 3.0);
}

TEST_P(CheckVehicles, ReportsThatNoMessageArrives) {
  bench.is_wire_cut = true;
  ASSERT_TRUE(bench.run(20.0));
  EXPECT_FALSE(bench.check.is_ready(bench.now));
  EXPECT_NE(bench.description().find("no message received from an autopilot at udp://:1"),
            std::string::npos);
}

TEST(CheckVehiclesOfAnotherKind, ReportsTheWrongKind) {
  Bench bench(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot);
  ASSERT_TRUE(bench.run(20.0));
  EXPECT_NE(bench.description().find("the autopilot is not ArduPilot"), std::string::npos);
}

}  // namespace
}  // namespace vantage::tools
