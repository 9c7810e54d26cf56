// Tests the effects of poses of another body, and of poses with another clock, on a vehicle in
// flight and on its autopilot.

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "drivers/vicon/frame_filter.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::FlightState;
using test::FlightBench;

constexpr std::array kDialects{AutopilotDialect::kPx4, AutopilotDialect::kArdupilot};

/// After the vehicle was unseen for `gap_s`, a stationary body with its name appears `off_m` away.
struct ForeignRow {
  double gap_s;
  double off_m;
};
constexpr std::array kForeignRows{
    ForeignRow{0.0, 0.24}, ForeignRow{0.05, 0.24}, ForeignRow{0.3, 0.24}, ForeignRow{0.3, 0.4},
    ForeignRow{0.3, 0.58}, ForeignRow{0.3, 0.65},  ForeignRow{0.6, 0.24}, ForeignRow{0.6, 0.58}};
constexpr double kLeavesMostM = 0.8;

TEST(MocapIdentity, LandsNearbyWhenAnotherBodyAppearsUnderTheVehiclesName) {
  for (const AutopilotDialect dialect : kDialects) {
    for (const ForeignRow& row : kForeignRows) {
      SCOPED_TRACE(testing::Message() << name_of(dialect) << ", unseen for " << row.gap_s
                                      << " s, then " << row.off_m << " m away");
      FlightBench bench(dialect);
      ASSERT_TRUE(bench.take_off()) << bench.reasons();
      bench.run(2.0);
      const Eigen::Vector2d from_m = bench.place_m();
      bench.has_mocap = row.gap_s <= 0.0;
      bench.run(row.gap_s);
      bench.has_mocap = true;
      Eigen::Vector3d still_m = bench.vehicle.world_from_body().translation_m;
      still_m.x() += row.off_m;
      int frames = 0;
      bench.alter_frame = [&](models::MocapFrame& frame) {
        Eigen::Vector3d& place_m = frame.bodies.front().world_from_body.translation_m;
        place_m = still_m + Eigen::Vector3d(1e-4 * (++frames % 7), 0.0, 0.0);
      };
      double left_m = 0.0;
      bench.on_step = [&](Time) { left_m = std::max(left_m, (bench.place_m() - from_m).norm()); };
      EXPECT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 40.0)) << bench.reasons();
      EXPECT_LT(left_m, kLeavesMostM);
    }
  }
}

// Mocap swaps the names of two bodies, which can happen when it loses both.
struct SwapRow {
  double apart_m;
  double gap_s;
};
constexpr std::array kSwapRows{SwapRow{0.6, 0.3}, SwapRow{1.0, 0.1}, SwapRow{2.0, 0.2}};
constexpr double kFarM = 2.2;         // m; distance between the bodies at take-off
constexpr double kApproachMps = 0.3;  // m/s; approach speed of the other body in the air

TEST(MocapIdentity, HidesSwappedNamesFromTheVehicle) {
  for (const SwapRow& row : kSwapRows) {
    SCOPED_TRACE(testing::Message() << row.apart_m << " m apart, unseen for " << row.gap_s << " s");
    FlightBench bench(AutopilotDialect::kPx4);
    int published_wrong = 0;
    bool is_swapped = false;
    double other_x_m = 0.0;
    vicon::GateSettings gate;
    gate.predicted_max_m = 0.27;
    vicon::FrameFilter filter(gate, Duration{5'000}, [&](const models::MocapFrame& seen) {
      models::MocapFrame frame = seen;
      frame.stamp.run_id = 33;
      frame.stamp.sequence = frame.frame_number;
      const models::MocapBody* const own = frame.find("Q1");
      published_wrong += is_swapped && own != nullptr && !own->occluded ? 1 : 0;
      bench.driver->on_mocap(frame, bench.now);
    });
    bool is_hidden = false;
    std::uint32_t number = 0;
    vicon::SeenFrame seen;
    bench.on_capture = [&](const models::MocapFrame& frame) {
      seen.clear();
      seen.arrival = {bench.now, bench.now - FlightBench::kStart};
      seen.number = ++number;
      seen.latency_s = 0.0;
      seen.rate_hz = 100.0;
      const auto add = [&](const std::string& name, const Eigen::Vector3d& place_m) {
        vicon::SeenBody& body = seen.add();
        body.name = name;
        body.pose_state = is_hidden ? vicon::PoseState::kAbsent : vicon::PoseState::kSeen;
        body.world_from_body = frame.bodies.front().world_from_body;
        body.world_from_body.translation_m = place_m;
      };
      const Eigen::Vector3d own_m = frame.bodies.front().world_from_body.translation_m;
      Eigen::Vector3d other_m(other_x_m, 2.0, 1.0);
      other_m.z() += 1e-4 * (number % 7);
      add("Q1", is_swapped ? other_m : own_m);
      add("OTHER", is_swapped ? own_m : other_m);
      filter.accept(seen);
    };
    other_x_m = 2.0 + kFarM;
    ASSERT_TRUE(bench.take_off()) << bench.reasons();
    while (other_x_m > 2.0 + row.apart_m) {
      other_x_m -= 0.01 * kApproachMps;
      bench.run(0.01);
    }
    bench.run(1.0);
    ASSERT_TRUE(bench.is_armed());
    const Eigen::Vector2d from_m = bench.place_m();
    is_hidden = row.gap_s > 0.0;
    bench.run(row.gap_s);
    is_hidden = false;
    is_swapped = true;
    double left_m = 0.0;
    bench.on_step = [&](Time) { left_m = std::max(left_m, (bench.place_m() - from_m).norm()); };
    EXPECT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 40.0)) << bench.reasons();
    EXPECT_EQ(published_wrong, 0);
    EXPECT_GT(filter.counts().poses_swapped, 0);
    EXPECT_LT(left_m, kLeavesMostM);
  }
}

/// Number of poses that the driver sent, and the greatest error of their stamps.
struct PoseWatch {
  int poses = 0;
  double worst_s = 0.0;
  void look(const FlightBench& bench) {
    for (const auto& datagram : bench.sent) {
      wire::mavlink::Parser parser;
      parser.feed(datagram, [&](const wire::mavlink::Frame& frame) {
        if (const auto pose = wire::mavlink::unpack<wire::mavlink::Odometry>(frame)) {
          ++poses;
          const double time_s = 1e-6 * static_cast<double>(pose->time_usec);
          worst_s = std::max(worst_s, std::abs(to_seconds(bench.now.time_since_epoch()) - time_s));
        }
      });
    }
  }
};

TEST(MocapIdentity, ForwardsPosesThroughAClockChange) {
  using std::chrono::hours;
  for (const AutopilotDialect dialect : kDialects) {
    for (const Duration set : {Duration{-hours(1)}, Duration{-std::chrono::seconds(1)},
                               Duration{hours(1)}, Duration{std::chrono::seconds(1)}}) {
      SCOPED_TRACE(testing::Message()
                   << name_of(dialect) << ", set by " << to_seconds(set) << " s");
      FlightBench bench(dialect);
      ASSERT_TRUE(bench.take_off()) << bench.reasons();
      bench.run(2.0);
      bench.alter_frame = [&](models::MocapFrame& frame) { frame.stamp.time += set; };
      PoseWatch watch;
      bench.on_step = [&](Time) { watch.look(bench); };
      bench.run(6.0);
      EXPECT_GE(watch.poses, 280) << "50 per second";
      EXPECT_LT(watch.worst_s, 0.05);
      EXPECT_EQ(bench.state(), FlightState::kHold) << bench.reasons();
      EXPECT_FALSE(bench.has_reason("estimat")) << bench.reasons();
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
