#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "sim/autopilot/airframe.hpp"
#include "sim/autopilot/pose_estimator.hpp"
#include "sim/autopilot/profile.hpp"
#include "sim/autopilot/settings.hpp"

namespace vantage::sim {

/// Content of a position set-point; local frame.
struct FlightTarget {
  std::optional<Eigen::Vector3d> position_m;
  std::optional<Eigen::Vector3d> velocity_mps;
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();
  std::optional<double> yaw_rad;
  double yaw_rate_radps = 0.0;
};

struct StatusText {
  std::uint8_t severity = 6;
  std::string text;
};

/// Flight control of an emulated autopilot: modes, arming, failsafes and control of an Airframe. It
/// rejects commands and triggers failsafes under the conditions observed in recordings of the real
/// autopilot. Time is an argument.
class FlightController {
 public:
  FlightController(const AutopilotProfile& profile, const AutopilotSettings& settings,
                   const AirframeParameters& airframe, std::uint64_t seed,
                   const Eigen::Vector3d& position_m, double yaw_rad, Time boot);

  /// Applies the user's settings from now on.
  void set_settings(const AutopilotSettings& settings);

  /// Each of these functions returns the result code of an acknowledgement; 0: accepted.
  std::uint8_t arm(Time now);
  std::uint8_t disarm(bool is_forced);
  std::uint8_t set_mode(std::uint32_t mode, Time now);
  std::uint8_t take_off(double height_m);

  void take_target(const FlightTarget& target, Time now);
  void take_pose(Time now, Time capture, const Eigen::Vector3d& position_m, std::uint8_t resets);
  /// Processes a heartbeat of the system `system_id`.
  void take_heartbeat(int system_id, Time now);
  /// Sets a fault that prevents arming; an empty text clears it.
  void set_fault(std::string why) { fault_ = std::move(why); }
  void set_origin() { has_origin_ = true; }
  /// True if the estimator has started, so that it accepts an origin.
  [[nodiscard]] bool has_estimator(Time now) const {
    return to_seconds(now - boot_) >= profile_.estimator_boot_s;
  }

  /// Steps by `dt_s` to `now`.
  void step(Time now, double dt_s);

  [[nodiscard]] bool is_armed() const { return is_armed_; }
  [[nodiscard]] std::uint32_t mode() const { return mode_; }
  /// Returns the state as in EXTENDED_SYS_STATE: 1 on the ground, 2 in the air, 3 taking off, 4
  /// landing.
  [[nodiscard]] std::uint8_t landed_state() const;
  [[nodiscard]] bool has_position(Time now) const;
  [[nodiscard]] bool has_origin() const { return has_origin_; }
  [[nodiscard]] std::uint16_t estimator_flags(Time now) const;
  [[nodiscard]] const Airframe& airframe() const { return airframe_; }
  [[nodiscard]] Airframe& airframe() { return airframe_; }
  [[nodiscard]] const PoseEstimator& estimator() const { return estimator_; }
  /// Returns the status texts since the last call.
  std::vector<StatusText> take_texts() { return std::exchange(texts_, {}); }

 private:
  void queue_text(std::uint8_t severity, std::string text) {
    texts_.push_back({severity, std::move(text)});
  }
  void watch(Time now);
  void check_timeouts(Time now);
  void watch_ground(Time now);
  void enter_landing(Time now);
  /// Starts a failsafe landing and sends the text `why`.
  void fail_safe(const std::string& why, Time now);
  void stop_motors();
  [[nodiscard]] bool has_proof_of_life(Time now) const;
  /// Returns the reasons against arming now, in the wording of the real autopilot.
  [[nodiscard]] std::vector<std::string> arming_problems(Time now) const;
  [[nodiscard]] bool is_following() const { return mode_ == profile_.follow_mode; }
  /// Returns the velocity to command now; nullopt to stay on the ground.
  [[nodiscard]] std::optional<Eigen::Vector3d> wanted_velocity_mps(Time now) const;
  [[nodiscard]] Eigen::Vector3d velocity_towards_mps(const Eigen::Vector3d& position_m) const;
  void control(const std::optional<Eigen::Vector3d>& wanted_mps, double dt_s);
  [[nodiscard]] double wanted_yaw_rate_radps() const;

  const AutopilotProfile& profile_;
  AutopilotSettings settings_;
  Airframe airframe_;
  PoseEstimator estimator_;
  Time boot_;
  Time now_;
  std::uint32_t mode_;
  bool is_armed_ = false;
  bool has_lifted_ = false;  ///< the vehicle has lifted since arming
  bool has_origin_ = false;
  bool is_blind_ = false;
  Time armed_at_{};
  std::optional<Time> touched_down_;  ///< start of the time on the ground after a flight
  std::optional<Time> lost_since_;
  std::optional<FlightTarget> target_;
  Time target_time_{};
  std::optional<Time> station_heartbeat_;
  bool is_station_lost_ = false;
  Time station_checked_{};
  Time descends_at_{};  ///< start of the descent in landing mode
  /// start of the current uninterrupted stream of set-points
  std::optional<Time> targets_since_;
  std::optional<Eigen::Vector3d> climb_to_m_;  ///< m; goal of a commanded take-off
  Eigen::Vector3d landing_at_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d shaped_mps_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d integral_mps2_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d commanded_mps2_ = Eigen::Vector3d::Zero();
  double yaw_rate_radps_ = 0.0;  ///< yaw rate commanded to the airframe
  std::string fault_;
  std::vector<StatusText> texts_;
};

}  // namespace vantage::sim
