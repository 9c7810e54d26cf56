#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/course.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/surroundings.hpp"
#include "scenario/scenario.hpp"

// First small lift of a take-off, one vehicle at a time. It verifies that the commanded vehicle is
// the body that mocap shows under its name. Only then does the vehicle continue.

namespace vantage::drivers {

/// Queue that decides which vehicle may lift next. Vehicles lift in the order of their take-off
/// commands; vehicles of one command lift in the order of names. Mocap shows when a lift is
/// complete.
///
/// A vehicle that was commanded to lift but does not rise is skipped after lift_wait_s + 6 s; the 6
/// s are for the start of its motors. A vehicle that has risen is skipped lift_proof_s later, so no
/// vehicle waits forever. When the queue is free, each vehicle waits 0.15 s longer than the one
/// before it in the scenario, so two vehicles never begin simultaneously.
class LiftQueue {
 public:
  LiftQueue(const scenario::Scenario& scenario, const std::string& own_name);

  /// Records a take-off command for `robot`; for all robots if `robot` is empty.
  void on_take_off(const std::string& robot);
  /// Records that another vehicle reports its first lift. The report begins when its motors start,
  /// before mocap can show a rise.
  void on_lifting(const std::string& robot, Time now);
  /// Restarts the wait for this vehicle's turn, because motors have started or stopped.
  void begin_turn(Time now) { blocked_last_ = now; }
  /// Deletes this vehicle's take-off command, because it is done, refused or revoked.
  void forget_own();
  /// Updates the queue from the positions of `bodies`, as returned by a Fleet of the same scenario.
  void update(std::span<const OtherBody> bodies, const SafetyLimits& limits, Time now);
  /// Begins this vehicle's lift: from now on the rise of other robots' bodies is measured.
  void begin_own();

  /// True if another vehicle is in its first lift, must lift before this one, or has just ended its
  /// lift.
  [[nodiscard]] bool is_blocked() const { return is_blocked_; }
  /// Returns the largest rise of another robot's body since this vehicle's lift began, m; 0 if none
  /// rises.
  [[nodiscard]] double other_risen_m() const { return other_risen_m_; }

 private:
  struct Entry {
    std::string name;
    bool is_ordered = false;
    std::int64_t order = 0;
    bool is_seen = false;
    double height_m = 0.0;
    double rest_m = 0.0;   ///< m; lowest measured height
    double begun_m = 0.0;  ///< m; height when this vehicle's lift began
    double climb_mps = 0.0;
    bool has_reported = false;
    Time reported_at{};  ///< time of the last report of its first lift
  };
  [[nodiscard]] static bool is_before(const Entry& a, const Entry& b);

  std::vector<Entry> robots_;  ///< entries in the order of the scenario
  std::size_t own_ = 0;
  std::int64_t orders_ = 0;
  std::size_t front_;  ///< index of the first vehicle in the queue; robots_.size() if empty
  Time front_since_{};
  bool is_blocked_ = false;
  Time blocked_last_{};
  double other_risen_m_ = 0.0;
};

/// First lift of this vehicle. The vehicle climbs to lift_height_m above its ground position, then
/// makes a small step and a small turn. It continues once mocap has shown all three motions.
class Lift {
 public:
  enum class Phase {
    kNone,     ///< on the ground, or after the first lift
    kRising,   ///< commanded to climb
    kProving,  ///< hovers; commanded to make a step and to turn
  };

  /// Begins the climb from the current pose. The step goes in the direction with the largest
  /// clearance.
  void begin(const Pose3& world_from_body, std::span<const OtherBody> others,
             const SafetyLimits& limits, Time now);
  void end() { phase_ = Phase::kNone; }
  /// Updates the phase from the current pose and moves the hover of `course`. Returns true at the
  /// tick at which the verification is complete.
  [[nodiscard]] bool step(const Eigen::Vector3d& position_m, double yaw_rad, Course& course,
                          const SafetyLimits& limits, Time now);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool is_under_way() const { return phase_ != Phase::kNone; }
  /// Returns the hover height during the verification, m.
  [[nodiscard]] double height_m() const { return height_m_; }
  [[nodiscard]] double rest_m() const { return rest_m_.z(); }
  /// Returns the time since the climb was commanded, s; 0 once the vehicle has risen.
  [[nodiscard]] double no_rise_s(const Eigen::Vector3d& position_m, const SafetyLimits& limits,
                                 Time now) const;
  /// Returns the time since the verification began, s; 0 outside that phase.
  [[nodiscard]] double proof_pending_s(Time now) const;
  /// Returns the horizontal distance from the segment between ground position and step goal, m.
  [[nodiscard]] double deviation_m(const Eigen::Vector3d& position_m) const;

 private:
  Phase phase_ = Phase::kNone;
  Time since_{};
  Eigen::Vector3d rest_m_ = Eigen::Vector3d::Zero();
  double rest_yaw_rad_ = 0.0;
  Eigen::Vector3d step_m_ = Eigen::Vector3d::Zero();
  double height_m_ = 0.0;
  /// m; position at which the verification began
  Eigen::Vector3d proof_from_m_ = Eigen::Vector3d::Zero();
  double proof_from_yaw_rad_ = 0.0;
};

}  // namespace vantage::drivers
