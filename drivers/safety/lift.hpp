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

// The first small lift of a take-off: one vehicle at a time, and none goes on before the vehicle
// that is commanded has been proven to be the body that is seen.

namespace vantage::drivers {

/// Whose turn it is to lift, by what the operator was heard to say to whom, in the order in which
/// it was said and by name where it was said at once; and by what mocap shows.
///
/// Who is told and does not rise is passed by after lift_wait_s and the time that motors take to
/// start, who has risen after lift_proof_s more: nobody waits for ever. After somebody's turn each
/// waits a moment longer than the one before it in the scenario, so that two who have waited for
/// the same do not begin together.
class LiftQueue {
 public:
  LiftQueue(const scenario::Scenario& scenario, const std::string& own_name);

  /// The operator told `robot` to take off; everybody, when it is empty.
  void on_take_off(const std::string& robot);
  /// Another vehicle says that it is at its first lift: before mocap can show it, while its motors
  /// spool up.
  void on_lifting(const std::string& robot, Time now);
  /// Our motors have begun to turn: our turn is waited for from here on.
  void begin_turn(Time now) { taken_last_ = now; }
  /// Our own order is over: done, refused or taken back.
  void forget_own();
  /// Looks where everybody is. `bodies` are the fleet's, of the same scenario.
  void look(std::span<const OtherBody> bodies, const SafetyLimits& limits, Time now);
  /// Our own lift begins: from now on a body that rises instead of ours is one too many.
  void begin_own();

  /// Somebody has to lift before us, or is lifting.
  [[nodiscard]] bool is_taken() const { return is_taken_; }
  /// How far another robot's body has risen since our own lift began, while it rises.
  [[nodiscard]] double other_risen_m() const { return other_risen_m_; }

 private:
  struct Entry {
    std::string name;
    bool is_told = false;
    std::int64_t order = 0;
    bool is_seen = false;
    double height_m = 0.0;
    double rest_m = 0.0;   ///< lowest that it was seen
    double begun_m = 0.0;  ///< when our own lift began
    double climb_mps = 0.0;
    bool has_said = false;
    Time said{};  ///< last that it was lifting
  };
  [[nodiscard]] static bool is_before(const Entry& a, const Entry& b);

  std::vector<Entry> robots_;  ///< as in the scenario
  std::size_t own_ = 0;
  std::int64_t orders_ = 0;
  std::size_t front_;  ///< of the queue; robots_.size(): nobody
  Time front_since_{};
  bool is_taken_ = false;
  Time taken_last_{};
  double other_risen_m_ = 0.0;
};

/// Our own first lift: up to lift_height_m above where it stood, a small step to the side and a
/// small turn, and on when mocap has shown each of them.
class Lift {
 public:
  enum class Phase {
    kNone,     ///< on the ground, or past it
    kRising,   ///< told to climb
    kProving,  ///< hovers; told to go a step aside and to turn
  };

  /// Told to climb from where it stands. The step aside goes where there is most room.
  void begin(const Pose3& world_from_body, std::span<const OtherBody> others,
             const SafetyLimits& limits, Time now);
  void end() { phase_ = Phase::kNone; }
  /// Where it is now; moves the hover of `course`. True when it has just been proven.
  [[nodiscard]] bool step(const Eigen::Vector3d& position_m, double yaw_rad, Course& course,
                          const SafetyLimits& limits, Time now);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool is_under_way() const { return phase_ != Phase::kNone; }
  /// Height of the hover of the proof.
  [[nodiscard]] double height_m() const { return height_m_; }
  [[nodiscard]] double rest_m() const { return rest_m_.z(); }
  /// Since it was told to climb, while it has not risen.
  [[nodiscard]] double unrisen_s(const Eigen::Vector3d& position_m, const SafetyLimits& limits,
                                 Time now) const;
  /// Since it hovers without a proof.
  [[nodiscard]] double unproven_s(Time now) const;
  /// Seen from above, from the way between where it stood and its step aside.
  [[nodiscard]] double astray_m(const Eigen::Vector3d& position_m) const;

 private:
  Phase phase_ = Phase::kNone;
  Time since_{};
  Eigen::Vector3d rest_m_ = Eigen::Vector3d::Zero();
  double rest_yaw_rad_ = 0.0;
  Eigen::Vector3d step_m_ = Eigen::Vector3d::Zero();
  double height_m_ = 0.0;
  Eigen::Vector3d proof_from_m_ = Eigen::Vector3d::Zero();  ///< where the proof began
  double proof_from_yaw_rad_ = 0.0;
};

}  // namespace vantage::drivers
