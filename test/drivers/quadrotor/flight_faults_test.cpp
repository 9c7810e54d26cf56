// Tests faults between a driver and a flying vehicle: poses of another body, a one-way link, a
// restarted driver, pilots, and delayed commands.

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/quadrotor/flight_bench.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;
using test::FlightBench;

class FlightFaults : public ::testing::TestWithParam<AutopilotDialect> {
 protected:
  FlightBench bench{GetParam()};
  [[nodiscard]] bool is_px4() const { return GetParam() == AutopilotDialect::kPx4; }
  [[nodiscard]] std::uint32_t landing_mode() const { return traits_of(GetParam()).land_mode; }
  [[nodiscard]] double height_m() const {
    return bench.vehicle.world_from_body().translation_m.z() - FlightBench::kFloorM;
  }
  void pilot_takes_over() {
    bench.vehicle.controller().set_mode(is_px4() ? 3U << 16U : 5U, bench.now);
  }
};

/// True if `datagram` contains a frame that satisfies `is_meant`.
bool has(const std::vector<std::uint8_t>& datagram,
         const std::function<bool(const wire::mavlink::Frame&)>& is_meant) {
  bool found = false;
  wire::mavlink::Parser parser;
  parser.feed(datagram,
              [&](const wire::mavlink::Frame& frame) { found = found || is_meant(frame); });
  return found;
}

/// Returns the horizontal position in a message, in the world frame, m.
Eigen::Vector2d position_of(const auto& message) {
  return {static_cast<double>(message.x), -static_cast<double>(message.y)};
}

INSTANTIATE_TEST_SUITE_P(Dialects, FlightFaults,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

// After an occlusion, mocap shows the body of another vehicle under this vehicle's name. Flight
// safety rejects the pose, so the pose must not affect control.
TEST_P(FlightFaults, IgnoresARejectedPose) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(2.0);
  const Eigen::Vector2d place_m = bench.place_m();
  bench.has_mocap = false;
  bench.run(0.7);
  bench.has_mocap = true;
  bench.alter_frame = [](models::MocapFrame& frame) {
    frame.bodies.front().world_from_body.translation_m.x() += 1.0;
  };
  bench.run(0.02);  // waits for frames that were captured earlier
  int poses = 0;
  double sent_offset_m = 0.0;  // m; greatest offset of a sent pose from the hover
  bench.on_step = [&](Time) {
    for (const auto& datagram : bench.sent) {
      has(datagram, [&](const wire::mavlink::Frame& frame) {
        const auto see = [&](const auto& message, bool is_pose) {
          if (message) {
            const Eigen::Vector2d at_m = position_of(*message);
            sent_offset_m = std::max(sent_offset_m, (at_m - place_m).norm());
            poses += is_pose ? 1 : 0;
          }
        };
        see(wire::mavlink::unpack<wire::mavlink::Odometry>(frame), true);
        see(wire::mavlink::unpack<wire::mavlink::VisionPositionEstimate>(frame), true);
        see(wire::mavlink::unpack<wire::mavlink::SetPositionTargetLocalNed>(frame), false);
        return false;
      });
    }
  };
  bench.run(0.7);
  EXPECT_EQ(poses, 0);
  EXPECT_LT(sent_offset_m, 0.3);
  bench.alter_frame = nullptr;
  bench.run(0.1);
  EXPECT_GT(poses, 0) << "poses of the vehicle itself are sent again";
  EXPECT_LT(sent_offset_m, 0.3);
}

// The radio fails in one direction: the vehicle still receives the driver, but the driver receives
// nothing. The vehicle must not hover permanently.
TEST_P(FlightFaults, LandsAVehicleFromWhichNothingIsReceived) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.driver_receives_nothing = true;
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 60.0)) << height_m();
  EXPECT_NEAR(height_m(), 0.0, 1e-6);
}

// A driver that is restarted in flight lands the vehicle by set-points. It must not use the landing
// mode of the autopilot, which does not stop for a body below.
TEST_P(FlightFaults, RestartedDriverLandsBySetPoints) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(2.0);
  bench.restart_driver();
  ASSERT_TRUE(bench.run_until([&] { return bench.state() == FlightState::kHold; }, 3.0))
      << bench.reasons();
  bench.run(1.0);
  double handed_over_m = 0.0;
  bench.on_step = [&](Time) {
    if (bench.vehicle.controller().mode() == landing_mode()) {
      handed_over_m = std::max(handed_over_m, height_m());
    }
  };
  bench.command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 30.0)) << bench.reasons();
  EXPECT_LT(handed_over_m, 0.4);
}

// An arm command is lost and then withdrawn by the operator; the driver must not send it again.
TEST_P(FlightFaults, DoesNotRepeatAWithdrawnArm) {
  ASSERT_TRUE(bench.run_until(
      [this] {
        return bench.now > FlightBench::kStart + from_seconds(1.0) && bench.reasons().empty();
      },
      20.0));
  int lost = 0;
  bool is_lossy = true;
  bench.loses_sent = [&](const std::vector<std::uint8_t>& datagram) {
    const bool is_arm = has(datagram, [](const wire::mavlink::Frame& frame) {
      const auto command = wire::mavlink::unpack<wire::mavlink::CommandLong>(frame);
      return command && command->command == wire::mavlink::command::kArmDisarm &&
             command->param1 == 1.0F;
    });
    lost += is_arm && is_lossy ? 1 : 0;
    return is_arm && is_lossy;
  };
  bench.command(OperatorAction::kArm);
  ASSERT_TRUE(bench.run_until([&] { return lost == 1; }, 10.0)) << bench.reasons();
  bench.command(OperatorAction::kHold);
  bench.run(0.1);
  is_lossy = false;
  bool has_armed = false;
  bench.on_step = [&](Time) { has_armed = has_armed || bench.is_armed(); };
  bench.run(5.0);
  EXPECT_FALSE(has_armed);
}

// The console repeats `hold` for almost a second. A pilot who takes over during this time must keep
// control.
TEST_P(FlightFaults, RepeatedCommandKeepsThePilotInControl) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  const models::OperatorCommand hold = bench.order(OperatorAction::kHold);
  bench.driver->on_command(hold, bench.now);
  pilot_takes_over();
  const std::uint32_t theirs = bench.vehicle.controller().mode();
  for (int i = 0; i < 20; ++i) {
    bench.run(0.1);
    bench.driver->on_command(bench.repeated(hold), bench.now);
    EXPECT_EQ(bench.vehicle.controller().mode(), theirs) << i;
  }
  bench.command(OperatorAction::kHold);
  bench.run(1.0);
  EXPECT_NE(bench.vehicle.controller().mode(), theirs) << "a new command takes control";
}

// A pilot flies manually, perhaps because mocap is bad. When mocap loses the vehicle, the state
// becomes LAND, but the driver sends no landing command, whether or not it receives the vehicle. In
// a hold mode of the autopilot there may be no pilot, so the driver lands the vehicle. An operator
// command takes control from the pilot, also when the pilot has taken over a second time.
TEST_P(FlightFaults, DoesNotTakeOverFromAPilotWithoutACommand) {
  for (const bool is_by_hand : {true, false}) {
    for (const bool driver_receives_nothing : {true, false}) {
      SCOPED_TRACE(testing::Message()
                   << "by hand " << is_by_hand << ", deaf " << driver_receives_nothing);
      FlightBench up(GetParam());
      ASSERT_TRUE(up.take_off()) << up.reasons();
      int orders_to_land = 0;
      up.loses_sent = [&](const std::vector<std::uint8_t>& datagram) {
        orders_to_land += has(datagram, [&](const wire::mavlink::Frame& frame) {
          const auto command = wire::mavlink::unpack<wire::mavlink::CommandLong>(frame);
          const auto land = land_command(GetParam());
          return command && command->command == land.command && command->param2 == land.param2;
        });
        return false;
      };
      const auto takes_over = [&] {
        const std::uint32_t hold = is_px4() ? 3U << 24U | 4U << 16U : 17U;
        const std::uint32_t by_hand = is_px4() ? 3U << 16U : 5U;
        up.vehicle.controller().set_mode(is_by_hand ? by_hand : hold, up.now);
      };
      takes_over();
      up.run(2.0);
      EXPECT_EQ(up.state(), FlightState::kHold);
      up.has_mocap = false;
      up.driver_receives_nothing = driver_receives_nothing;
      ASSERT_TRUE(up.run_until([&] { return up.state() == FlightState::kLand; }, 3.0));
      up.run(3.0);
      if (!is_by_hand) {
        EXPECT_GT(orders_to_land, 0);
        continue;
      }
      EXPECT_EQ(up.state(), FlightState::kLand) << up.reasons();
      EXPECT_EQ(orders_to_land, 0);
      up.driver_receives_nothing = false;
      up.has_mocap = true;
      for (int round = 0; round < 2; ++round) {  // repeated with the same vehicle
        takes_over();
        up.run(3.0);
        EXPECT_EQ(orders_to_land, 0) << round;
        up.command(OperatorAction::kLand);
        up.run(1.5);  // heartbeats report the mode once per second
        EXPECT_EQ(orders_to_land, 1) << up.reasons();
        orders_to_land = 0;
      }
    }
  }
}

// Poses return during a blind landing while a body moves in below. The controlled landing resumes
// and stops above the body. If the vehicle is near the ground, the blind landing continues.
TEST_P(FlightFaults, ResumesTheLandingWhenPosesReturn) {
  struct Row {
    double begins_m;  ///< m; height of the vehicle when poses return
    bool is_steered;
  };
  for (const Row& row : {Row{1.3, true}, Row{0.8, true}, Row{0.62, true}, Row{0.3, false}}) {
    SCOPED_TRACE(testing::Message() << "poses back at " << row.begins_m << " m");
    FlightBench up(GetParam());
    up.scenario.robots[0].height_m = 1.6;
    up.restart_driver();
    ASSERT_TRUE(up.take_off()) << up.reasons();
    const auto above_floor_m = [&] {
      return up.vehicle.world_from_body().translation_m.z() - FlightBench::kFloorM;
    };
    up.has_mocap = false;
    ASSERT_TRUE(up.run_until(
        [&] {
          return up.vehicle.controller().mode() == landing_mode() && above_floor_m() < row.begins_m;
        },
        20.0))
        << up.reasons();
    up.has_mocap = true;
    const Eigen::Vector2d here_m = up.place_m();
    up.walker_m = {here_m.x(), here_m.y(), FlightBench::kFloorM + 0.05};
    double lowest_m = above_floor_m();  // m; least height of the vehicle above the body
    up.on_step = [&](Time) {
      const bool is_above = (up.place_m() - here_m).norm() < 0.4;
      lowest_m = is_above ? std::min(lowest_m, above_floor_m()) : lowest_m;
    };
    up.run(6.0);
    if (row.is_steered) {
      EXPECT_GT(lowest_m, 0.15) << up.reasons();
      up.walker_m.reset();
      up.on_step = nullptr;
    }
    EXPECT_TRUE(up.run_until([&] { return !up.is_armed(); }, 30.0)) << up.reasons();
  }
}

// pymavlink sends as component 0 by default. A companion that does so in flight must not interrupt
// the set-points.
TEST_P(FlightFaults, KeepsSetPointsDespiteComponent0) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  Time last = bench.now;
  Duration gap{};
  int inserted = 0;
  bench.on_step = [&](Time now) {
    if (++inserted % 60 == 0) {
      std::vector<std::uint8_t> bytes;
      wire::mavlink::append_bytes(
          wire::mavlink::pack(wire::mavlink::Heartbeat{0, 18, 8, 0, 4, 3}, {1, 0, 0}), bytes);
      bench.driver->receive(bytes, true, now);
    }
    for (const auto& datagram : bench.sent) {
      if (has(datagram, [](const wire::mavlink::Frame& frame) {
            return frame.message_id == wire::mavlink::SetPositionTargetLocalNed::kMessage.id;
          })) {
        gap = std::max(gap, now - last);
        last = now;
      }
    }
  };
  bench.run(5.0);
  EXPECT_LT(to_seconds(gap), 0.06);
  EXPECT_EQ(bench.state(), FlightState::kHold) << bench.reasons();
  EXPECT_FALSE(bench.has_reason("mode")) << bench.reasons();
}

// Faults that would stop the motors of a vehicle under the driver's control do not stop them under
// a pilot's control.
TEST_P(FlightFaults, StopsAPilotedVehicleOnlyOnCommand) {
  using Breaks = std::function<void(FlightBench&)>;
  const Breaks shows_it_outside = [](FlightBench& up) {
    up.alter_frame = [](models::MocapFrame& frame) {
      frame.bodies.front().world_from_body.translation_m.x() -= 3.5;
    };
  };
  const Breaks says_it_is_tilted = [](FlightBench& up) {
    up.on_step = [&up](Time now) {
      wire::mavlink::Attitude attitude;
      attitude.roll = 1.4F;
      std::vector<std::uint8_t> bytes;
      wire::mavlink::append_bytes(
          wire::mavlink::pack(attitude, {1, wire::mavlink::kComponentAutopilot, 0}), bytes);
      up.driver->receive(bytes, true, now);
    };
  };
  for (const Breaks& breaks : {shows_it_outside, says_it_is_tilted}) {
    FlightBench up(GetParam());
    ASSERT_TRUE(up.take_off()) << up.reasons();
    up.vehicle.controller().set_mode(is_px4() ? 3U << 16U : 5U, up.now);
    up.run(2.0);
    // After a gap, mocap shows the vehicle at another position, and that pose is accepted.
    up.has_mocap = false;
    up.run(0.4);
    up.has_mocap = true;
    breaks(up);
    up.run(3.0);
    EXPECT_TRUE(up.is_armed()) << up.reasons();
    up.command(OperatorAction::kEmergencyStop);
    up.run(0.5);
    EXPECT_FALSE(up.is_armed()) << up.reasons();
  }
}

// The vehicle lands when the autopilot sends no attitude.
TEST_P(FlightFaults, LandsWithoutAnAttitude) {
  for (const bool is_told_as_nan : {false, true}) {
    FlightBench up(GetParam());
    ASSERT_TRUE(up.take_off()) << up.reasons();
    up.loses_received = [](const std::vector<std::uint8_t>& datagram) {
      return has(datagram, [](const wire::mavlink::Frame& frame) {
        return frame.message_id == wire::mavlink::Attitude::kMessage.id;
      });
    };
    up.on_step = [&](Time now) {
      if (is_told_as_nan) {
        wire::mavlink::Attitude none;
        none.roll = none.pitch = std::numeric_limits<float>::quiet_NaN();
        std::vector<std::uint8_t> bytes;
        wire::mavlink::append_bytes(
            wire::mavlink::pack(none, {1, wire::mavlink::kComponentAutopilot, 0}), bytes);
        up.driver->receive(bytes, true, now);
      }
    };
    up.run(0.4);
    EXPECT_EQ(up.state(), FlightState::kHold);
    up.run(1.6);
    EXPECT_EQ(up.state(), FlightState::kLand) << up.reasons();
    EXPECT_TRUE(up.has_reason("no attitude received from the autopilot")) << up.reasons();
  }
}

}  // namespace
}  // namespace vantage::drivers
