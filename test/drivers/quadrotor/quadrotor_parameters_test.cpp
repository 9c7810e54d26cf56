// Tests the reaction of the driver to the parameters and the battery of its autopilot before arming
// and in flight.

#include <gtest/gtest.h>

#include "test/drivers/quadrotor/flight_bench.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;
using scenario::ParameterPolicy;
using test::FlightBench;

class Parameters : public ::testing::TestWithParam<AutopilotDialect> {
 protected:
  FlightBench bench{GetParam()};
  /// Returns the name of the parameter that limits the time without set-points.
  std::string loss_name() const {
    return GetParam() == AutopilotDialect::kPx4 ? "COM_OF_LOSS_T" : "GUID_TIMEOUT";
  }
  /// Commands arming; returns true if the motors run within `seconds`.
  bool arms_within(double seconds) {
    bench.command(OperatorAction::kArm);
    return bench.run_until([this] { return bench.is_armed(); }, seconds);
  }
  void use(ParameterPolicy policy) {
    bench.scenario.robots[0].autopilot->parameters = policy;
    bench.restart_driver();
  }
};
INSTANTIATE_TEST_SUITE_P(Dialects, Parameters,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST_P(Parameters, ForbidArmingWhenTheirValuesDiffer) {
  bench.vehicle.set_parameter(loss_name(), 3.0);
  bench.run(30.0);
  EXPECT_TRUE(bench.has_reason(loss_name() + " is 3, must be at most")) << bench.reasons();
  EXPECT_TRUE(bench.has_reason("it flies on for this time after the driver dies"));
  EXPECT_FALSE(arms_within(10.0));
  EXPECT_NEAR(bench.driver->parameters().value(loss_name()).value_or(0.0), 3.0, 1e-6);
}

// Regression: the rules allowed a time-out of 0.5 s, but the stopping distance was budgeted with
// 0.3 s.
TEST_P(Parameters, ForbidArmingWithATimeOutBeyondTheBudget) {
  bench.vehicle.set_parameter(loss_name(), 0.5);
  bench.run(30.0);
  EXPECT_TRUE(bench.has_reason(loss_name() + " is 0.5, must be at most 0.3")) << bench.reasons();
  EXPECT_FALSE(arms_within(10.0));
}

// Sets the longest permitted time-out and measures the stopping distance after the last set-point.
TEST_P(Parameters, StopWithinTheBudgetWhenTheDriverDies) {
  bench.vehicle.set_parameter(loss_name(), 0.3);
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(3.0);
  ASSERT_TRUE(bench.follow_straight(0.8)) << bench.reasons();
  const Eigen::Vector2d from_m = bench.place_m();
  const double speed_mps = bench.speed_mps();
  ASSERT_GT(speed_mps, 0.7);
  bench.is_wire_cut = true;
  double farthest_m = 0.0;
  bench.on_step = [&](Time) {
    farthest_m = std::max(farthest_m, (bench.place_m() - from_m).norm());
  };
  bench.run(4.0);
  EXPECT_LT(farthest_m,
            stopping_distance_after_loss_m(limits_for(bench.scenario, "Q1"), speed_mps) + 0.1);
  EXPECT_GT(farthest_m, 0.3 * speed_mps) << "the vehicle was not in motion";
}

TEST_P(Parameters, ForbidArmingWhenMissing) {
  bench.vehicle.forget_parameter(loss_name());
  bench.run(30.0);
  EXPECT_TRUE(bench.has_reason(loss_name() + " is missing")) << bench.reasons();
  EXPECT_FALSE(arms_within(10.0));
}

TEST_P(Parameters, AllowArmingOnceCorrected) {
  bench.vehicle.set_parameter(loss_name(), 3.0);
  bench.run(30.0);
  ASSERT_TRUE(bench.has_reason(loss_name()));
  bench.vehicle.set_parameter(loss_name(), 0.3);
  bench.run(35.0);  // includes the next request of the parameters
  EXPECT_FALSE(bench.has_reason(loss_name())) << bench.reasons();
  EXPECT_TRUE(arms_within(60.0)) << bench.reasons();
}

TEST_P(Parameters, AreReadAgainAfterALostLink) {
  bench.run(10.0);
  ASSERT_TRUE(bench.driver->parameters().is_kept());
  bench.is_wire_cut = true;
  bench.run(5.0);
  bench.vehicle.set_parameter(loss_name(), 3.0);
  bench.is_wire_cut = false;
  bench.run(5.0);
  EXPECT_FALSE(bench.driver->parameters().is_kept()) << "the value has changed";
  EXPECT_FALSE(arms_within(10.0));
}

TEST_P(Parameters, AreOnlyReportedWhenConfigured) {
  use(ParameterPolicy::kWarn);
  bench.vehicle.set_parameter(loss_name(), 3.0);
  bench.run(30.0);
  EXPECT_TRUE(bench.has_reason("warning: " + loss_name() + " is 3")) << bench.reasons();
  EXPECT_TRUE(arms_within(60.0)) << bench.reasons();
}

TEST_P(Parameters, AreNotRequestedWhenIgnored) {
  use(ParameterPolicy::kIgnore);
  bench.vehicle.set_parameter(loss_name(), 3.0);
  bench.run(30.0);
  EXPECT_EQ(bench.reasons(), "");
  EXPECT_TRUE(arms_within(60.0)) << bench.reasons();
}

TEST_P(Parameters, AreNotRequestedInFlight) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  std::int64_t requests = 0;
  bench.on_step = [&](Time) {
    wire::mavlink::Parser parser;
    for (const auto& datagram : bench.sent) {
      parser.feed(datagram, [&](const wire::mavlink::Frame& frame) {
        requests += frame.message_id == wire::mavlink::ParamRequestRead::kMessage.id ? 1 : 0;
      });
    }
  };
  bench.run(40.0);
  EXPECT_EQ(requests, 0);
}

/// Tests with autopilots that do not report their charge correctly.
class Battery : public ::testing::TestWithParam<AutopilotDialect> {
 protected:
  static std::unique_ptr<FlightBench> bench_with(sim::BatteryReport report, double share) {
    sim::AutopilotEmulatorSpec vehicle = FlightBench::vehicle_for(GetParam());
    vehicle.battery = report;
    vehicle.airframe.battery_start_share = share;
    return std::make_unique<FlightBench>(GetParam(), vehicle);
  }
  /// Returns a bench with a scenario that contains the voltages of the battery.
  static std::unique_ptr<FlightBench> known_bench(sim::BatteryReport report, double share) {
    auto bench = bench_with(report, share);
    bench->scenario.robots[0].autopilot->battery = scenario::BatterySpec{3, 3.4, 4.1};
    bench->restart_driver();
    return bench;
  }
};
INSTANTIATE_TEST_SUITE_P(Dialects, Battery,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST_P(Battery, ReportsAMissingCharge) {
  const auto bench = bench_with(sim::BatteryReport::kVoltageOnly, 1.0);
  bench->run(30.0);
  EXPECT_TRUE(bench->has_reason("does not report its battery's charge")) << bench->reasons();
  bench->command(OperatorAction::kArm);
  EXPECT_FALSE(bench->run_until([&] { return bench->is_armed(); }, 10.0));
}

TEST_P(Battery, IsEstimatedFromVoltageWhenConfigured) {
  const auto bench = known_bench(sim::BatteryReport::kVoltageOnly, 1.0);
  ASSERT_TRUE(bench->take_off()) << bench->reasons();
  bench->run(15.0);
  EXPECT_EQ(bench->state(), FlightState::kHold) << bench->reasons();
  const double share = bench->driver->telemetry().battery_share().value_or(-1.0);
  EXPECT_GT(share, 0.4);
  EXPECT_LT(share, 0.95) << "under load the voltage is lower";
}

TEST_P(Battery, LandsTheVehicleByItsVoltage) {
  const auto bench = known_bench(sim::BatteryReport::kVoltageOnly, 1.0);
  ASSERT_TRUE(bench->take_off()) << bench->reasons();
  bench->vehicle.controller().airframe().set_battery_share(0.1);
  EXPECT_TRUE(bench->run_until([&] { return bench->state() == FlightState::kLand; }, 40.0))
      << bench->reasons();
  EXPECT_TRUE(bench->run_until([&] { return !bench->is_armed(); }, 40.0)) << bench->reasons();
}

TEST_P(Battery, IgnoresAChargeThatCountsDownFromFull) {
  // ArduCopter 4.6.2 reported 100 % for a three-cell battery at 10.6 V, because it assumes a full
  // battery at power-up.
  const auto bench = known_bench(sim::BatteryReport::kFromFull, 0.05);
  bench->run(30.0);
  EXPECT_LT(bench->driver->telemetry().battery_share().value_or(1.0), 0.45);
  EXPECT_TRUE(bench->has_reason("battery")) << bench->reasons();
}

}  // namespace
}  // namespace vantage::drivers
