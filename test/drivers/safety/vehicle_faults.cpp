#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {
namespace {

/// Sets the battery share; if several faults limit it, the lowest limit applies.
Act caps_battery(double share) {
  return [share](FlightBench& bench, double) {
    q1(bench).battery_share = std::min(share, q1(bench).battery_share.value_or(1.0));
  };
}

}  // namespace

std::vector<Fault> vehicle_faults() {
  return {
      fault(29, "estimator fails", "the autopilot reports that its estimate is unreliable",
            sets(&VehicleKnobs::estimator_bad, true),
            ends(kIdle, {{kHold, 0.2 + kTicks}, {kLand, 1.0 + kTicks}}, "estimator failed")),
      fault(29, "estimate 0.5 m off", "", sets(&VehicleKnobs::estimate_offset_m, 0.5),
            ends(kHold, {{kHold, 0.1 + kTicks}}, "estimate off")),
      fault(29, "estimate 1.5 m off", "", sets(&VehicleKnobs::estimate_offset_m, 1.5),
            ends(kIdle, {{kLand, kTicks}}, "estimate lost")),
      fault(32, "gust", "3 m/s² for 0.5 s, across",
            lasting(0.5, sets(&VehicleKnobs::push_mps2, {0.0, -3.0, 0.0})), flies_on()),
      fault(
          32, "pushed aside by hand", "1 m/s for 1 s, along the lane",
          [](FlightBench& bench, double since_s) {
            if (since_s < 1.0) {
              q1(bench).runaway_mps = {bench.vehicle("Q1").heads_east ? -1.5 : 1.5, 0.0, 0.0};
            }
          },
          ends(kFollow, {{kHold, 0.8}}, "tracking")),
      fault(
          33, "pushed towards the fence", "1.6 m/s until it is in HOLD",
          [](FlightBench& bench, double since_s) {
            if (since_s < 0.9 && bench.vehicle("Q1").out.state == kFollow) {
              q1(bench).runaway_mps = {0.0, -1.6, 0.0};
            }
          },
          ends(kFollow, {{kHold, 0.7}}, "fence ahead")),
      fault(
          33, "pushed through the fence", "1.4 m/s until 0.05 m before the fence",
          [](FlightBench& bench, double since_s) {
            if (since_s < 0.8 && bench.vehicle("Q1").position_m.y() > -1.9) {
              q1(bench).runaway_mps = {0.0, -1.4, 0.0};
            }
          },
          ends(kIdle, {{kHold, 0.7}, {kLand, 1.0}}, "fence")),
      fault(34, "battery critical", "10 %", caps_battery(0.10),
            ends(kIdle, {{kLand, 3.5 + kTicks}}, "battery critical")),
      fault(34, "battery empty", "3 %", sets(&VehicleKnobs::battery_share, 0.03),
            ends(kIdle, {{kLand, 0.5 + kTicks}}, "battery empty")),
      fault(34, "voltage sags for 1 s", "10 % under load", lasting(1.0, caps_battery(0.10)),
            flies_on()),
      fault(34, "battery low", "20 %", caps_battery(0.20), flies_on_with_reason("battery low")),
      fault(34, "battery silent", "no battery messages", sets(&VehicleKnobs::battery_silent, true),
            ends(kIdle, {{kLand, 10.0 + kTicks}}, "battery silent")),
      fault(35, "motor lost", "the autopilot reports it", sets(&VehicleKnobs::motor_failed, true),
            ends(kIdle, {{kLand, kTicks}}, "motor")),
      fault(35, "attitude beyond 60°", "", sets(&VehicleKnobs::tilt_rad, 1.3),
            ends(kKilled, {{kKilled, 0.1 + kTicks}}, "tilt")),
      fault(37, "link cut for 1.2 s", "no bytes in either direction",
            lasting(1.2, sets(&VehicleKnobs::link_cut, true)),
            ends(kFollow, {{kHold, 0.5 + kTicks}}, "telemetry stale")),
      fault(37, "link cut permanently", "no bytes in either direction",
            sets(&VehicleKnobs::link_cut, true),
            ends(kLand, {{kHold, 0.5 + kTicks}, {kLand, 3.0 + kTicks}}, "autopilot lost")),
      fault(37, "telemetry stops", "heartbeats continue", sets(&VehicleKnobs::telemetry_cut, true),
            ends(kHold, {{kHold, 0.5 + kTicks}}, "telemetry stale")),
      fault(37, "pilot takes over", "the autopilot leaves the driver's mode",
            sets(&VehicleKnobs::mode_left, true),
            ends(kHold, {{kHold, 0.5 + kTicks}}, "autopilot disobeys")),
      fault(38, "driver requested to end", "SIGTERM", sets(&VehicleKnobs::is_ending, true),
            ends(kIdle, {{kLand, kTicks}}, "ending")),
      delaying(0.04, fault(45, "own process stalls for 40 ms", "",
                           lasting(0.04, sets(&VehicleKnobs::is_stalled, true)), flies_on())),
      delaying(0.4, fault(45, "own process stops for 0.4 s", "",
                          lasting(0.4, sets(&VehicleKnobs::is_stalled, true)),
                          ends(kFollow, {{kHold, 0.4 + kTicks}}, "driver stalled", "tick.stalls"))),
      fault(45, "own process waits 0.2 s of each second", "for a processor",
            sets(&VehicleKnobs::processor_wait_s, 0.2), flies_on_with_reason("host busy")),
      fault(45, "own process waits 0.4 s of each second for 2 s", "for a processor",
            lasting(2.0, sets(&VehicleKnobs::processor_wait_s, 0.4)),
            ends(kFollow, {{kHold, kTicks}}, "waits for processor")),
      fault(45, "own process waits 0.4 s of each second", "for a processor",
            sets(&VehicleKnobs::processor_wait_s, 0.4),
            ends(kIdle, {{kHold, kTicks}, {kLand, 3.0 + kTicks}}, "short of processor")),
  };
}

}  // namespace vantage::test::faults
