#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {
namespace {

Act body(BodyFault fault) {
  return [fault](FlightBench& bench, double) { q1(bench).body.push_back(fault); };
}
Act swaps_names() {
  return [](FlightBench& bench, double) {
    q1(bench).swapped_with = "Q2";
    q2(bench).swapped_with = "Q1";
  };
}
/// Sets the mocap latency, s; of two latency faults the longer one applies.
Act latency(double latency_s) {
  return [latency_s](FlightBench& bench, double) {
    bench.room().mocap_latency_s = std::max(latency_s, bench.room().mocap_latency_s);
  };
}

}  // namespace

std::vector<Fault> mocap_faults() {
  const std::vector<Stage> gone = {{kHold, 0.10 + kTicks}, {kLand, 0.50 + kTicks}};
  std::vector<Stage> to_the_end = gone;
  to_the_end.push_back({kKilled, 10.0});
  /// Returns a fault in which mocap shows the body wrongly, as given by `how`.
  const auto refused_poses = [&](int number, const char* name, const char* what, BodyFault how) {
    return fault(number, name, what, body(how), ends(kKilled, to_the_end, "pose implausible"));
  };
  return {
      fault(1, "one frame without the body", "occluded for 10 ms",
            lasting(0.01, body(BodyFault::kOccluded)), flies_on_counting("pose.absent")),
      fault(2, "outage 0.1 s", "occluded for 0.15 s", lasting(0.15, body(BodyFault::kOccluded)),
            ends(kFollow, {{kHold, 0.10 + kTicks}}, "pose stale")),
      fault(2, "outage 0.5 s", "occluded for 0.6 s", lasting(0.6, body(BodyFault::kOccluded)),
            ends(kIdle, gone, "pose lost")),
      fault(2, "outage 2 s", "occluded for 2 s", lasting(2.0, body(BodyFault::kOccluded)),
            ends(kIdle, gone, "pose lost")),
      fault(2, "permanent outage", "the body stays absent", body(BodyFault::kAbsent),
            ends(kKilled, to_the_end, "pose lost low")),
      for_all(fault(3, "camera server ends", "no frames arrive", sets(&RoomKnobs::mocap_dead, true),
                    ends(kKilled, to_the_end, "pose lost low"))),
      fault(4, "stuck while moving", "the last pose is repeated", body(BodyFault::kFrozen),
            ends(kKilled, to_the_end, "pose stale")),
      after(2.0,
            fault(4, "stuck while hovering", "the same, after `hold`",
                  both(sends_command(OperatorAction::kHold), from(2.0, body(BodyFault::kFrozen))),
                  ends(kKilled, {{kHold, kTicks}, {kLand, 0.55 + kTicks}, {kKilled, 10.0}},
                       "pose lost"))),
      on("Q1 Q2", fault(5, "two bodies swapped for 0.3 s", "Q1 and Q2 have each other's name",
                        lasting(0.3, swaps_names()),
                        ends(kHold, {{kHold, 0.10 + kTicks}}, "pose implausible"))),
      on("Q1 Q2", fault(5, "two bodies swapped permanently", "Q1 and Q2 have each other's name",
                        swaps_names(), ends(kKilled, to_the_end, "pose implausible"))),
      after(2.0,
            fault(5, "a stationary body has its name", "0.24 m away, after `hold`",
                  both(sends_command(OperatorAction::kHold), from(2.0, body(BodyFault::kForeign))),
                  ends(kIdle, {{kHold, kTicks}, {kLand, 2.3}}, "hover unsteady"))),
      fault(5, "the autopilot reports another motion", "its velocity differs by 1 m/s",
            sets(&VehicleKnobs::velocity_offset_mps, 1.0),
            ends(kIdle, {{kHold, 1.6}, {kLand, 2.5}}, "pose foreign")),
      for_all(fault(6, "ghost body", "an unknown name 0.1 m from Q1",
                    sets(&RoomKnobs::ghost_body, true), flies_on_counting("mocap.unknown_bodies"))),
      fault(6, "two bodies with one name", "the second is 0.4 m away", body(BodyFault::kDuplicated),
            ends(kKilled, to_the_end, "pose lost")),
      fault(7, "outlier of 1 m in one frame", "",
            lasting(0.005, [](FlightBench& bench, double) { q1(bench).offset_m += 1.0; }),
            flies_on_counting("pose.jump")),
      fault(7, "permanent jump of 1 m", "", sets(&VehicleKnobs::offset_m, 1.0),
            ends(kKilled, to_the_end, "pose implausible")),
      fault(7, "flipped in one frame", "upside down", lasting(0.005, body(BodyFault::kUpsideDown)),
            flies_on_counting("pose.flip")),
      refused_poses(7, "flipped permanently", "upside down", BodyFault::kUpsideDown),
      refused_poses(8, "not a number", "NaN in a position", BodyFault::kNotANumber),
      refused_poses(8, "not a rotation", "zero quaternion", BodyFault::kZeroQuaternion),
      refused_poses(8, "quaternion not normalised", "quaternion of length 1.5",
                    BodyFault::kLongQuaternion),
      refused_poses(8, "millimetres instead of metres", "", BodyFault::kMillimetres),
      refused_poses(8, "frame mirrored in flight", "y changes its sign", BodyFault::kMirrored),
      for_all(delaying(
          0.05, fault(9, "rate falls to 20 Hz", "", sets(&RoomKnobs::mocap_every, 5), flies_on()))),
      for_all(fault(9, "rate falls to 8 Hz", "", sets(&RoomKnobs::mocap_every, 12),
                    ends(kHold, {{kHold, 0.22 + kTicks}}, "pose stale"))),
      for_all(delaying(0.04, fault(9, "latency 5 to 35 ms", "", latency(0.035), flies_on()))),
      for_all(fault(9, "latency 5 to 155 ms", "", latency(0.155),
                    ends(kHold, {{kHold, 0.10 + kTicks}}, "pose late"))),
      for_all(delaying(0.06, fault(9, "jitter of 50 ms", "", sets(&RoomKnobs::mocap_jitter_s, 0.05),
                                   flies_on()))),
      for_all(fault(10, "mocap clock one hour ahead", "",
                    sets(&RoomKnobs::mocap_clock, std::chrono::hours(1)),
                    flies_on_counting("mocap.clock_set"))),
      for_all(fault(10, "mocap clock one hour back", "",
                    sets(&RoomKnobs::mocap_clock, -std::chrono::hours(1)),
                    flies_on_counting("mocap.clock_set"))),
      for_all(fault(
          10, "mocap clock drifts by 1 %", "runs ahead",
          [](FlightBench& bench, double since_s) {
            bench.room().mocap_clock = from_seconds(0.01 * since_s);
          },
          flies_on())),
      for_all(delaying(0.04, fault(12, "20 % of the frames lost", "at random",
                                   sets(&RoomKnobs::frame_loss, 0.2), flies_on()))),
  };
}

}  // namespace vantage::test::faults
