#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {
namespace {

template <BodyFault fault>
void body_always(FlightBench& bench, double) {
  q1(bench).body.push_back(fault);
}
template <int milliseconds, BodyFault fault>
void body_for(FlightBench& bench, double since_s) {
  if (since_s < 1e-3 * milliseconds) {
    q1(bench).body.push_back(fault);
  }
}

}  // namespace

std::vector<Fault> of_mocap() {
  const std::vector<Stage> gone = {{kHold, 0.10 + kTicks}, {kLand, 0.50 + kTicks}};
  std::vector<Stage> to_the_end = gone;
  to_the_end.push_back({kKilled, 10.0});
  return {
      {1,
       "one frame without the body",
       "occluded for 10 ms",
       "Q1",
       0.0,
       body_for<10, BodyFault::kOccluded>,
       {},
       nullptr,
       "pose.absent",
       kFollow},
      {2,
       "outage 0.1 s",
       "occluded for 0.15 s",
       "Q1",
       0.0,
       body_for<150, BodyFault::kOccluded>,
       {{kHold, 0.10 + kTicks}},
       "pose stale",
       nullptr,
       kFollow},
      {2, "outage 0.5 s", "occluded for 0.6 s", "Q1", 0.0, body_for<600, BodyFault::kOccluded>,
       gone, "pose lost", nullptr, kIdle},
      {2, "outage 2 s", "occluded for 2 s", "Q1", 0.0, body_for<2000, BodyFault::kOccluded>, gone,
       "pose lost", nullptr, kIdle},
      {2, "outage for good", "absent from then on", "Q1", 0.0, body_always<BodyFault::kAbsent>,
       to_the_end, "pose lost low", nullptr, kKilled},
      {3, "camera server dies", "no frame at all", "all", 0.0,
       [](FlightBench& bench, double) { bench.room().mocap_dead = true; }, to_the_end,
       "pose lost low", nullptr, kKilled},
      {4, "stuck while moving", "the last pose again and again", "Q1", 0.0,
       body_always<BodyFault::kFrozen>, to_the_end, "pose stale", nullptr, kKilled},
      {4,
       "stuck while hovering",
       "the same, after `hold`",
       "Q1",
       2.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kHold;
         }
         if (since_s >= 2.0) {
           q1(bench).body.push_back(BodyFault::kFrozen);
         }
       },
       {{kHold, kTicks}, {kLand, 0.55 + kTicks}, {kKilled, 10.0}},
       "pose lost",
       nullptr,
       kKilled},
      {5,
       "two bodies swapped for 0.3 s",
       "Q1 and Q2 carry each other's name",
       "Q1 Q2",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.3) {
           q1(bench).swapped_with = "Q2";
           q2(bench).swapped_with = "Q1";
         }
       },
       {{kHold, 0.10 + kTicks}},
       "pose implausible",
       nullptr,
       kHold},
      {5, "two bodies swapped for good", "Q1 and Q2 carry each other's name", "Q1 Q2", 0.0,
       [](FlightBench& bench, double) {
         q1(bench).swapped_with = "Q2";
         q2(bench).swapped_with = "Q1";
       },
       to_the_end, "pose implausible", nullptr, kKilled},
      {6,
       "ghost body",
       "an unknown name 0.1 m beside Q1",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().ghost_body = true; },
       {},
       nullptr,
       "mocap.unknown_bodies",
       kFollow},
      {6, "two bodies of one name", "the second 0.4 m away", "Q1", 0.0,
       body_always<BodyFault::kDuplicated>, to_the_end, "pose lost", nullptr, kKilled},
      {7,
       "outlier of 1 m in one frame",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         q1(bench).offset_m += since_s < 0.005 ? 1.0 : 0.0;
       },
       {},
       nullptr,
       "pose.jump",
       kFollow},
      {7, "jump of 1 m for good", "", "Q1", 0.0,
       [](FlightBench& bench, double) { q1(bench).offset_m = 1.0; }, to_the_end, "pose implausible",
       nullptr, kKilled},
      {7,
       "flipped in one frame",
       "upside down",
       "Q1",
       0.0,
       body_for<5, BodyFault::kUpsideDown>,
       {},
       nullptr,
       "pose.flip",
       kFollow},
      {7, "flipped for good", "upside down", "Q1", 0.0, body_always<BodyFault::kUpsideDown>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no number", "NaN in a position", "Q1", 0.0, body_always<BodyFault::kNotANumber>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no rotation", "zero quaternion", "Q1", 0.0, body_always<BodyFault::kZeroQuaternion>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no unit rotation", "quaternion of length 1.5", "Q1", 0.0,
       body_always<BodyFault::kLongQuaternion>, to_the_end, "pose implausible", nullptr, kKilled},
      {8, "millimetres for metres", "", "Q1", 0.0, body_always<BodyFault::kMillimetres>, to_the_end,
       "pose implausible", nullptr, kKilled},
      {8, "frame mirrored in flight", "y changes its sign", "Q1", 0.0,
       body_always<BodyFault::kMirrored>, to_the_end, "pose implausible", nullptr, kKilled},
      {9,
       "rate falls to 20 Hz",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_every = 5; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.05},
      {9,
       "rate falls to 8 Hz",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_every = 12; },
       {{kHold, 0.22 + kTicks}},
       "pose stale",
       nullptr,
       kHold},
      {9,
       "latency 5 to 35 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().mocap_latency_s = std::max(0.035, bench.room().mocap_latency_s);
       },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.04},
      {9,
       "latency 5 to 155 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().mocap_latency_s = std::max(0.155, bench.room().mocap_latency_s);
       },
       {{kHold, 0.10 + kTicks}},
       "pose late",
       nullptr,
       kHold},
      {9,
       "jitter of 50 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_jitter_s = 0.05; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.06},
      {10,
       "mocap clock one hour on",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_clock = std::chrono::hours(1); },
       {},
       nullptr,
       "mocap.clock_set",
       kFollow},
      {10,
       "mocap clock one hour back",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_clock = -std::chrono::hours(1); },
       {},
       nullptr,
       "mocap.clock_set",
       kFollow},
      {10,
       "mocap clock drifts by 1 %",
       "runs ahead",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         bench.room().mocap_clock = from_seconds(0.01 * since_s);
       },
       {},
       nullptr,
       nullptr,
       kFollow},
      {12,
       "20 % of the frames lost",
       "at random",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().frame_loss = 0.2; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.04},
  };
}

}  // namespace vantage::test::faults
