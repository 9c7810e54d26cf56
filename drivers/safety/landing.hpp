#pragma once

#include <span>

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/height_state.hpp"

namespace vantage::drivers {

/// Landing of one flying vehicle: it stops, moves to a landing spot and descends. The descent stops
/// if a body enters below, unless the landing is committed (low or of long duration) or blind.
class Landing {
 public:
  /// Begins a landing at the current height; ends a climb.
  void begin(GuardCore& core, HeightState& height, Time now);
  /// Advances the landing by `dt_s`.
  /// @param is_blind  the landing has no position that it can use
  void step(GuardCore& core, HeightState& height, bool is_blind, double dt_s, Time now);

  /// True if the vehicle descends at its spot.
  [[nodiscard]] bool is_sinking() const { return is_sinking_; }

 private:
  /// Measured and commanded position at the current height, and the other bodies, in one tick.
  struct View {
    Eigen::Vector3d here_m;
    Eigen::Vector3d hover_m;  ///< m; commanded position
    std::span<const OtherBody> bodies;
    bool is_below_us = false;  ///< a body is below the vehicle
    bool is_free = false;      ///< no body is below the vehicle or its commanded position
  };
  void seek_spot(GuardCore& core, const View& view, Time now);
  void sink(const GuardCore& core, HeightState& height, double dt_s);

  Time since_{}, spot_since_{};
  Eigen::Vector3d spot_m_ = Eigen::Vector3d::Zero();
  bool has_spot_ = false;
  bool is_sinking_ = false;
  bool is_committed_ = false;
};

}  // namespace vantage::drivers
