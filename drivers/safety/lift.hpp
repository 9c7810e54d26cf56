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

// First small lift of a take-off: one vehicle at a time. A vehicle continues only after the
// commanded vehicle has been proven to be the body that mocap shows.

namespace vantage::drivers {

/// Queue that decides which vehicle may lift: in the order in which take-off orders were received,
/// by name within one order, and by what mocap shows.
///
/// An ordered vehicle that does not rise is skipped after lift_wait_s and 6 s for the start of its
/// motors; one that has risen, after lift_proof_s more. No vehicle waits forever. After each turn a
/// vehicle waits 0.15 s longer than the one before it in the scenario. Two vehicles that waited for
/// the same turn therefore do not begin together.
class LiftQueue {
 public:
  LiftQueue(const scenario::Scenario& scenario, const std::string& own_name);

  /// Records a take-off order for `robot`; for all robots if it is empty.
  void on_take_off(const std::string& robot);
  /// Records that another vehicle reports its first lift. It reports it while its motors start,
  /// before mocap can show it.
  void on_lifting(const std::string& robot, Time now);
  /// Restarts the wait for our own turn, because motors have started or stopped.
  void begin_turn(Time now) { blocked_last_ = now; }
  /// Ends our own order: done, refused or revoked.
  void forget_own();
  /// Updates the queue from the positions of `bodies`, which are the fleet's of the same scenario.
  void update(std::span<const OtherBody> bodies, const SafetyLimits& limits, Time now);
  /// Begins our own lift: from now on the rise of another robot's body is measured.
  void begin_own();

  /// True if another vehicle lifts, or must lift before us, or did so a moment ago.
  [[nodiscard]] bool is_blocked() const { return is_blocked_; }
  /// Returns how far another robot's body has risen since our own lift began, m; 0 if none rises.
  [[nodiscard]] double other_risen_m() const { return other_risen_m_; }

 private:
  struct Entry {
    std::string name;
    bool is_ordered = false;
    std::int64_t order = 0;
    bool is_seen = false;
    double height_m = 0.0;
    double rest_m = 0.0;   ///< m; lowest height seen
    double begun_m = 0.0;  ///< m; height when our own lift began
    double climb_mps = 0.0;
    bool has_reported = false;
    Time reported_at{};  ///< last report that it was lifting
  };
  [[nodiscard]] static bool is_before(const Entry& a, const Entry& b);

  std::vector<Entry> robots_;  ///< in the order of the scenario
  std::size_t own_ = 0;
  std::int64_t orders_ = 0;
  std::size_t front_;  ///< first of the queue; robots_.size(): empty
  Time front_since_{};
  bool is_blocked_ = false;
  Time blocked_last_{};
  double other_risen_m_ = 0.0;
};

/// First lift of our own vehicle. It climbs to lift_height_m above its ground position and makes a
/// small step and a small turn. It continues once mocap has shown each of them.
class Lift {
 public:
  enum class Phase {
    kNone,     ///< on the ground, or after the first lift
    kRising,   ///< commanded to climb
    kProving,  ///< hovers; commanded to step aside and to turn
  };

  /// Begins the climb from the current pose. The step goes to the side with the most room.
  void begin(const Pose3& world_from_body, std::span<const OtherBody> others,
             const SafetyLimits& limits, Time now);
  void end() { phase_ = Phase::kNone; }
  /// Advances by the current pose and moves the hover of `course`. Returns true at the tick at
  /// which the proof is complete.
  [[nodiscard]] bool step(const Eigen::Vector3d& position_m, double yaw_rad, Course& course,
                          const SafetyLimits& limits, Time now);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool is_under_way() const { return phase_ != Phase::kNone; }
  /// Returns the height of the hover of the proof, m.
  [[nodiscard]] double height_m() const { return height_m_; }
  [[nodiscard]] double rest_m() const { return rest_m_.z(); }
  /// Returns the time since the climb was commanded, s; 0 once it has risen.
  [[nodiscard]] double no_rise_s(const Eigen::Vector3d& position_m, const SafetyLimits& limits,
                                 Time now) const;
  /// Returns the duration of the hover of the proof, s; 0 outside that phase.
  [[nodiscard]] double proof_pending_s(Time now) const;
  /// Returns the horizontal distance from the segment between ground position and step, m.
  [[nodiscard]] double deviation_m(const Eigen::Vector3d& position_m) const;

 private:
  Phase phase_ = Phase::kNone;
  Time since_{};
  Eigen::Vector3d rest_m_ = Eigen::Vector3d::Zero();
  double rest_yaw_rad_ = 0.0;
  Eigen::Vector3d step_m_ = Eigen::Vector3d::Zero();
  double height_m_ = 0.0;
  Eigen::Vector3d proof_from_m_ = Eigen::Vector3d::Zero();  ///< position at which the proof began
  double proof_from_yaw_rad_ = 0.0;
};

}  // namespace vantage::drivers
