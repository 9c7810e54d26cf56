#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/autopilot/flight_controller.hpp"
#include "sim/autopilot/profile.hpp"

namespace vantage::test {

constexpr Time kPilotBoot = from_utime(1'700'000'000'000'000);
constexpr double kPilotDtS = 0.005;

inline sim::AirframeParameters still_air() {
  sim::AirframeParameters out;
  out.wind_sigma_mps = 0.0;
  return out;
}

inline sim::AutopilotSettings settings() {
  sim::AutopilotSettings out;
  out.setpoint_loss_s = 0.5;
  out.pose_loss_s = 2.0;
  out.speed_max_mps = 1.5;
  out.land_speed_mps = 0.4;
  out.land_disarm_s = 0.5;
  out.yaw_rate_max_radps = 1.0;
  return out;
}

/// An emulated flight controller, and a pilot that sends it poses and set-points at 50 Hz.
struct Pilot {
  explicit Pilot(models::AutopilotDialect dialect, const sim::AutopilotSettings& set = settings(),
                 const Eigen::Vector3d& place_m = {0.0, 0.0, 0.0}, double yaw_rad = 0.0)
      : profile(sim::profile_of(dialect)),
        controller(profile, set, still_air(), 1, place_m, yaw_rad, kPilotBoot) {}
  void step() {
    if (ticks++ % 4 == 0) {
      if (gives_poses) {
        controller.take_pose(now, now, controller.airframe().position_m(), 0);
      }
      if (target) {
        controller.take_target(*target, now);
      }
    }
    now += Duration{5'000};
    controller.step(now, kPilotDtS);
    for (const sim::StatusText& text : controller.take_texts()) {
      texts.push_back(text.text);
    }
  }
  void run(double seconds) {
    for (int n = 0; n < std::lround(seconds / kPilotDtS); ++n) {
      step();
    }
  }
  /// Steps while the condition is true, for a minute at most.
  template <class Condition>
  void run_while(const Condition& is_so) {
    const Time begin = now;
    while (is_so()) {
      ASSERT_LT(to_seconds(now - begin), 60.0);
      step();
    }
  }
  [[nodiscard]] Eigen::Vector3d place_m() const { return controller.airframe().position_m(); }
  /// Takes off to `up_m` above the ground.
  void take_off(double up_m) {
    run(1.0);
    target = sim::FlightTarget{};
    target->position_m = place_m() - Eigen::Vector3d(0.0, 0.0, up_m);
    target->yaw_rad = controller.airframe().yaw_rad();
    if (profile.takes_off_by_command) {
      controller.set_origin();
      run(24.0);
    } else {
      run(1.2);
    }
    EXPECT_EQ(controller.set_mode(profile.follow_mode, now), 0);
    EXPECT_EQ(controller.arm(now), 0);
    if (profile.takes_off_by_command) {
      EXPECT_EQ(controller.take_off(up_m), 0);
    }
    run(up_m / 0.5 + 6.0);
    EXPECT_NEAR(place_m().z(), target->position_m->z(), 0.1);
  }

  const sim::AutopilotProfile& profile;
  sim::FlightController controller;
  Time now = kPilotBoot;
  std::int64_t ticks = 0;
  bool gives_poses = true;
  std::optional<sim::FlightTarget> target;
  std::vector<std::string> texts;
};

}  // namespace vantage::test
