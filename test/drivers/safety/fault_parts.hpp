#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "test/drivers/safety/fault_catalogue.hpp"

/// Helpers shared by the parts of the fault catalogue; only those parts include it.
namespace vantage::test::faults {

using models::FlightState;
using models::OperatorAction;
inline constexpr auto kFollow = FlightState::kFollow;
inline constexpr auto kHold = FlightState::kHold;
inline constexpr auto kLand = FlightState::kLand;
inline constexpr auto kIdle = FlightState::kIdle;
inline constexpr auto kKilled = FlightState::kKilled;

/// s; tolerance of time limits: one telemetry tick, one guard tick and one tick for rounding.
inline constexpr double kTicks = 0.03;

inline VehicleKnobs& q1(FlightBench& bench) { return bench.vehicle("Q1").knobs; }
inline VehicleKnobs& q2(FlightBench& bench) { return bench.vehicle("Q2").knobs; }

/// Sets a plan fault; if two faults corrupt the same plan, the first one applies.
inline void corrupt(VehicleKnobs& knobs, PlanFault fault) {
  knobs.plan = knobs.plan == PlanFault::kNone ? fault : knobs.plan;
}
/// True during one tick only.
inline bool is_at(double since_s, double at_s) { return std::abs(since_s - at_s) < 0.004; }

/// Returns an act that sets a knob of Q1 or of the whole bench.
template <class Knob, class Value = Knob>
Act sets(Knob VehicleKnobs::*knob, Value value) {
  return [knob, value](FlightBench& bench, double) { q1(bench).*knob = value; };
}
template <class Knob, class Value = Knob>
Act sets(Knob RoomKnobs::*knob, Value value) {
  return [knob, value](FlightBench& bench, double) { bench.room().*knob = value; };
}
/// Returns an act that runs at one tick only.
inline Act at(double at_s, Act act) {
  return [at_s, act = std::move(act)](FlightBench& bench, double since_s) {
    if (is_at(since_s, at_s)) {
      act(bench, since_s);
    }
  };
}
inline Act lasting(double lasts_s, Act act) {
  return [lasts_s, act = std::move(act)](FlightBench& bench, double since_s) {
    if (since_s < lasts_s) {
      act(bench, since_s);
    }
  };
}
inline Act from(double from_s, Act act) {
  return [from_s, act = std::move(act)](FlightBench& bench, double since_s) {
    if (since_s >= from_s) {
      act(bench, since_s);
    }
  };
}
inline Act both(Act one, Act other) {
  return [one = std::move(one), other = std::move(other)](FlightBench& bench, double since_s) {
    one(bench, since_s);
    other(bench, since_s);
  };
}
/// Returns an act in which the operator sends one command.
inline Act sends_command(OperatorAction action, double at_s = 0.0) {
  return at(at_s, sets(&RoomKnobs::command, action));
}

/// Expected reaction to a fault and the final state.
struct Expected {
  std::vector<Stage> stages;
  const char* reason = nullptr;
  const char* counter = nullptr;
  FlightState end = kFollow;
};
inline Expected flies_on() { return {}; }
inline Expected flies_on_counting(const char* counter) { return {{}, nullptr, counter}; }
inline Expected flies_on_with_reason(const char* reason, const char* counter = nullptr) {
  return {{}, reason, counter};
}
inline Expected ends(FlightState end, std::vector<Stage> stages, const char* reason = nullptr,
                     const char* counter = nullptr) {
  return {std::move(stages), reason, counter, end};
}

/// Returns a fault of Q1 that begins immediately.
inline Fault fault(int number, const char* name, const char* what, Act act, Expected expected) {
  return {number,
          name,
          what,
          "Q1",
          0.0,
          std::move(act),
          expected.stages,
          expected.reason,
          expected.counter,
          expected.end};
}
inline Fault on(const char* vehicles, Fault fault) {
  fault.vehicles = vehicles;
  return fault;
}
inline Fault for_all(Fault fault) { return on("all", std::move(fault)); }
inline Fault after(double begins_s, Fault fault) {
  fault.begins_s = begins_s;
  return fault;
}
inline Fault delaying(double delays_s, Fault fault) {
  fault.delays_s = delays_s;
  return fault;
}
inline Fault with_trusted_plans(Fault fault) {
  fault.trusts_plans = true;
  return fault;
}

/// Returns faults 1 … 12: cameras, mocap computer and its clock.
std::vector<Fault> mocap_faults();
/// Returns faults 14, 15, 23 … 31, 42: plans, planners, maps.
std::vector<Fault> plan_faults();
/// Returns faults 29, 31 … 35, 37, 38, 45: the vehicle, its autopilot, its link, the driver.
std::vector<Fault> vehicle_faults();
/// Returns faults 17 and 36: the operator.
std::vector<Fault> operator_faults();

}  // namespace vantage::test::faults
