#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::drivers::vicon {

/// What the gate makes of a pose.
enum class Verdict {
  kGood,
  kStuck,        ///< the same as before, bit by bit, too often for a live measurement
  kOutlier,      ///< no body moves that fast
  kFlip,         ///< nor turns that fast: markers taken for each other
  kUnconfirmed,  ///< first of a body that was long unseen
};

struct GateSettings {
  double speed_max_mps = 10.0;     ///< 0: no gate
  double turn_max_radps = 20.0;    ///< 0: attitudes are not judged
  double jump_margin_m = 0.15;     ///< allowed on top of the speed: noise, and frames that bunch
  double turn_margin_rad = 0.5;    ///< likewise
  Duration lost_after{1'000'000};  ///< unseen for so long, a body may be anywhere
  /// Greatest distance from the prediction at constant velocity, however long the gap: less than
  /// half of what keeps two bodies apart, so that another body's pose does not pass.
  double predicted_max_m = std::numeric_limits<double>::infinity();
  /// A swap of names is certain after a gap no longer than this; predictions are good by then.
  Duration swap_certain{400'000};
  /// The limits over what bodies usually do: 2 m/s and 4 rad/s, twice what flies in a laboratory.
  int usual_divisor = 5;
  int confirm_frames = 5;  ///< of a lost one, consistent with each other, before it is back
  /// A jump is believed after the poses since were consistent with each other for so long. By then
  /// whoever flies on this body has been without it for long enough to land (design §6).
  Duration believe_jump_after{2'000'000};
  int stuck_frames = 3;  ///< repetitions; 0: not judged
};

/// Decides, pose by pose, whether one body can be where it is said to be.
///
/// A good pose is within reach of the last good one. One that is not starts a chain of candidates;
/// later poses belong to the chain as long as they are within reach of its end, and stay refused
/// until the chain is believed. A pose within reach of the last good one is good again at once if
/// it is outside the chain, or farther from the chain's end than bodies usually go and nearer to
/// the good one: the chain's reach grows with every gap, and takes in where the body really is.
/// A chain that began where another body was (`is_other`), or with a pose that fits another body's
/// prediction better after a short gap, is never believed: names have been swapped. Such a chain
/// ends when the body goes farther than bodies usually go, or is unseen for lost_after.
class PoseGate {
 public:
  explicit PoseGate(const GateSettings& settings) : settings_(settings) {}

  /// @param is_other    whether a position is that of another body now; asked when a chain begins
  /// @param is_swapped  the pose fits another body's prediction better than this one's
  template <class IsOther>
  Verdict judge(Duration now, const Pose3& pose, const IsOther& is_other, bool is_swapped = false);

  /// True if the body was good so recently that its position can be predicted.
  [[nodiscard]] bool is_predicted(Duration now) const {
    return last_ && now - last_time_ <= settings_.lost_after;
  }
  /// Last good position, moved on at the last velocity for at most kPredictMax.
  /// Precondition: is_predicted().
  [[nodiscard]] Eigen::Vector3d predicted_m(Duration now) const;

  /// Where and when the body was last good.
  [[nodiscard]] const std::optional<Pose3>& last() const { return last_; }
  [[nodiscard]] Duration last_time() const { return last_time_; }
  [[nodiscard]] bool is_swap_suspected() const { return candidate_ && is_swap_; }

 private:
  static constexpr Duration kPredictMax{500'000};
  enum class Reach { kWithin, kTooFar, kTurned };
  [[nodiscard]] Reach reach(const Pose3& from, const Pose3& to, Duration elapsed) const;
  /// How far apart, in margins, by what is more: place or attitude.
  [[nodiscard]] double margins_between(const Pose3& a, const Pose3& b) const;
  /// Of a pose in reach of both: whether it belongs to the last good one, not to the chain's end.
  [[nodiscard]] bool is_back(Duration now, const Pose3& pose) const;
  [[nodiscard]] bool is_repeated(const Pose3& pose);
  Verdict accept(Duration now, const Pose3& pose);
  [[nodiscard]] bool is_believed(Duration now) const;
  [[nodiscard]] bool is_near_prediction(Duration now, const Pose3& pose) const;
  [[nodiscard]] bool continues_chain(Duration now, const Pose3& pose) const;

  GateSettings settings_;
  std::optional<Pose3> last_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  Duration last_time_{};
  std::optional<Pose3> candidate_;  ///< end of the chain
  Duration candidate_time_{};
  Duration candidate_since_{};
  int candidate_frames_ = 0;
  Verdict candidate_kind_ = Verdict::kOutlier;  ///< why the chain began
  bool is_swap_ = false;
  std::optional<Pose3> previous_;  ///< pose before, whatever became of it
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
  return is_believed(now) ? accept(now, pose) : candidate_kind_;
}

}  // namespace vantage::drivers::vicon
