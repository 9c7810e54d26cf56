#pragma once

#include <cmath>
#include <vector>

#include "test/drivers/safety/fault_catalogue.hpp"

/// What the parts of the catalogue have in common; only they include it.
namespace vantage::test::faults {

using models::FlightState;
using models::OperatorAction;
inline constexpr auto kFollow = FlightState::kFollow;
inline constexpr auto kHold = FlightState::kHold;
inline constexpr auto kLand = FlightState::kLand;
inline constexpr auto kIdle = FlightState::kIdle;
inline constexpr auto kKilled = FlightState::kKilled;

/// One tick of telemetry, one of ours, one for rounding.
inline constexpr double kTicks = 0.03;

inline VehicleKnobs& q1(FlightBench& bench) { return bench.vehicle("Q1").knobs; }
inline VehicleKnobs& q2(FlightBench& bench) { return bench.vehicle("Q2").knobs; }

/// Of two faults of one plan the first counts.
inline void spoil(VehicleKnobs& knobs, PlanFault fault) {
  knobs.plan = knobs.plan == PlanFault::kNone ? fault : knobs.plan;
}
/// True during one tick only.
inline bool is_at(double since_s, double at_s) { return std::abs(since_s - at_s) < 0.004; }

/// Numbers 1 … 12: cameras, their computer, their clock.
std::vector<Fault> of_mocap();
/// 14, 15, 23 … 31, 42: plans, planners, maps.
std::vector<Fault> of_plans();
/// 29, 31 … 35, 37, 45: the vehicle, its autopilot, its link, the driver itself.
std::vector<Fault> of_vehicles();
/// 17, 36: the operator.
std::vector<Fault> of_operators();

}  // namespace vantage::test::faults
