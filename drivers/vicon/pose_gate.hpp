#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::drivers::vicon {

/// Verdict of the gate on a pose.
enum class Verdict {
  kGood,
  kStuck,        ///< identical to the previous poses: not a new measurement
  kOutlier,      ///< farther from the last good pose than a body can move
  kFlip,         ///< larger rotation than a body can make: markers were confused
  kUnconfirmed,  ///< pose of a body that was long unseen, not yet confirmed by further poses
};

struct GateSettings {
  double speed_max_mps = 10.0;   ///< m/s; 0: poses are not checked
  double turn_max_radps = 20.0;  ///< rad/s; 0: attitudes are not checked
  /// m; added to the distance at maximum speed, for noise and frames that arrive in bursts
  double jump_margin_m = 0.15;
  double turn_margin_rad = 0.5;    ///< rad; allowance for the attitude
  Duration lost_after{1'000'000};  ///< a body unseen for longer may be at any position
  /// Largest distance from the constant-velocity prediction for any gap, m. It is less than half of
  /// the separation between bodies, so that another body's pose does not pass.
  double predicted_max_m = std::numeric_limits<double>::infinity();
  /// Longest gap after which a swap of names is certain; predictions are accurate for this time.
  Duration swap_certain{400'000};
  /// Ratio of the limits to usual motions. Usual motions have up to 2 m/s and 4 rad/s, twice the
  /// values of flights in the lab.
  int usual_divisor = 5;
  int confirm_frames = 5;  ///< number of consistent poses that confirm a lost body
  /// A jump is accepted after its poses were consistent for this time. By then, the
  /// vehicle with this body has had no accepted pose for long enough to land.
  Duration accept_jump_after{2'000'000};
  int stuck_frames = 3;  ///< number of repetitions of a stuck pose; 0: not checked
};

/// Gate that decides for each pose whether the body can be at the reported pose.
///
/// A pose is good if the body can have moved there from the last good pose: it is "within reach".
/// Any other pose starts a chain of candidates. Later poses within reach of the chain's end extend
/// the chain, and are refused until the chain is accepted. A pose within reach of the last good
/// pose is good immediately in two cases. Either it is out of reach of the chain, or it is nearer
/// to the last good pose and farther from the chain's end than bodies usually move. The second case
/// is needed because the chain's reach grows during gaps and may include the true position.
///
/// A chain indicates swapped names in two cases: it began at the position of another body
/// (`is_other`), or after a short gap at a pose closer to another body's prediction. Such a chain
/// is never accepted. It ends when the body moves faster than usual, or is unseen for lost_after.
class PoseGate {
 public:
  explicit PoseGate(const GateSettings& settings) : settings_(settings) {}

  /// @param is_other    function that returns true for the current position of another body; called
  /// when a chain begins
  /// @param is_swapped  the pose is closer to another body's prediction than to this body's
  template <class IsOther>
  Verdict judge(Duration now, const Pose3& pose, const IsOther& is_other, bool is_swapped = false);

  /// True if the last good pose is recent enough for a prediction.
  [[nodiscard]] bool is_predicted(Duration now) const {
    return last_ && now - last_time_ <= settings_.lost_after;
  }
  /// Returns the last good position, extrapolated at the last velocity for at most kPredictMax.
  /// Precondition: is_predicted().
  [[nodiscard]] Eigen::Vector3d predicted_m(Duration now) const;

  /// Returns the last good pose and its time.
  [[nodiscard]] const std::optional<Pose3>& last() const { return last_; }
  [[nodiscard]] Duration last_time() const { return last_time_; }
  [[nodiscard]] bool is_swap_suspected() const { return candidate_ && is_swap_; }

 private:
  static constexpr Duration kPredictMax{500'000};
  enum class Reach { kWithin, kTooFar, kTurned };
  [[nodiscard]] Reach reach(const Pose3& from, const Pose3& to, Duration elapsed) const;
  /// Returns the larger of the distances in position and attitude, in units of their margins.
  [[nodiscard]] double margins_between(const Pose3& a, const Pose3& b) const;
  /// True if a pose within reach of both the last good pose and the chain belongs to the last good
  /// pose.
  [[nodiscard]] bool is_back(Duration now, const Pose3& pose) const;
  [[nodiscard]] bool is_repeated(const Pose3& pose);
  Verdict accept(Duration now, const Pose3& pose);
  [[nodiscard]] bool is_accepted(Duration now) const;
  [[nodiscard]] bool is_near_prediction(Duration now, const Pose3& pose) const;
  [[nodiscard]] bool continues_chain(Duration now, const Pose3& pose) const;

  GateSettings settings_;
  std::optional<Pose3> last_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  Duration last_time_{};
  std::optional<Pose3> candidate_;  ///< last pose of the chain
  Duration candidate_time_{};
  Duration candidate_since_{};
  int candidate_frames_ = 0;
  Verdict candidate_kind_ = Verdict::kOutlier;  ///< verdict at the start of the chain
  bool is_swap_ = false;
  std::optional<Pose3> previous_;  ///< previous pose, with any verdict
  int repetitions_ = 0;
};

template <class IsOther>
Verdict PoseGate::judge(Duration now, const Pose3& pose, const IsOther& is_other, bool is_swapped) {
  if (is_repeated(pose)) {
    return Verdict::kStuck;
  }
  if (settings_.speed_max_mps <= 0.0 || !last_) {
    return accept(now, pose);
  }
  const bool is_lost = now - last_time_ > settings_.lost_after;
  const bool continues = continues_chain(now, pose);
  Reach from_last = reach(*last_, pose, std::min(now - last_time_, settings_.lost_after));
  if (from_last == Reach::kWithin && !is_lost && !is_near_prediction(now, pose)) {
    from_last = Reach::kTooFar;
  }
  if (from_last == Reach::kWithin && !is_lost && !is_swapped &&
      (!continues || is_back(now, pose))) {
    return accept(now, pose);
  }
  if (!continues || (is_swapped && candidate_kind_ != Verdict::kOutlier)) {
    candidate_since_ = now;
    candidate_frames_ = 0;
    candidate_kind_ = is_swapped                    ? Verdict::kOutlier
                      : is_lost                     ? Verdict::kUnconfirmed
                      : from_last == Reach::kTurned ? Verdict::kFlip
                                                    : Verdict::kOutlier;
    is_swap_ =
        candidate_kind_ == Verdict::kOutlier &&
        (is_swapped ? now - last_time_ <= settings_.swap_certain : is_other(pose.translation_m));
  }
  candidate_ = pose;
  candidate_time_ = now;
  ++candidate_frames_;
  return is_accepted(now) ? accept(now, pose) : candidate_kind_;
}

}  // namespace vantage::drivers::vicon
