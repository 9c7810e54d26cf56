#pragma once

#include <string>

#include "drivers/vicon/frame_filter.hpp"

namespace vantage::drivers::vicon {

inline constexpr Time kEpoch = from_utime(1'700'000'000'000'000);
inline constexpr Duration kPeriod{10'000};

/// Passes frames at 100 Hz to a frame filter and keeps its last output.
struct FilterBench {
  explicit FilterBench(const GateSettings& gate = {})
      : filter(gate, Duration{5'000}, [this](const models::MocapFrame& frame) { out = frame; }) {}

  SeenFrame& begin() {
    elapsed += kPeriod;
    seen.clear();
    seen.arrival = {kEpoch + elapsed, elapsed};
    seen.number = next_number++;
    seen.latency_s = 0.004;
    seen.rate_hz = 0.0;
    seen.echo.reset();
    return seen;
  }
  void add(const std::string& name, const Pose3& pose, PoseState pose_state = PoseState::kSeen) {
    SeenBody& body = seen.add();
    body.name = name;
    body.pose_state = pose_state;
    body.world_from_body = pose;
  }
  /// Passes a frame with one body; returns whether the filter publishes the body as seen.
  bool is_accepted(const Pose3& pose) {
    begin();
    add("A", pose);
    filter.accept(seen);
    return !out.bodies.at(0).occluded;
  }
  /// Returns the current pose of a body that moves along x at 1 m/s.
  Pose3 moving_pose() const {
    return {{to_seconds(elapsed), 0.0, 1.0}, Eigen::Quaterniond::Identity()};
  }

  models::MocapFrame out;
  FrameFilter filter;
  SeenFrame seen;
  Duration elapsed{};
  std::uint32_t next_number = 1;
};

}  // namespace vantage::drivers::vicon
