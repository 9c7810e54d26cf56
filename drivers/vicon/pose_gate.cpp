#include "drivers/vicon/pose_gate.hpp"

#include <cmath>

namespace vantage::drivers::vicon {
namespace {

constexpr double kVelocityMemory_s = 0.05;

}  // namespace

PoseGate::Reach PoseGate::reach(const Pose3& from, const Pose3& to, Duration elapsed) const {
  const double elapsed_s = std::max(0.0, to_seconds(elapsed));
  const double moved_m = (to.translation_m - from.translation_m).norm();
  if (moved_m > settings_.jump_margin_m + settings_.speed_max_mps * elapsed_s) {
    return Reach::kTooFar;
  }
  const double turned_rad = from.rotation.angularDistance(to.rotation);
  const double turn_allowed_rad = settings_.turn_margin_rad + settings_.turn_max_radps * elapsed_s;
  return settings_.turn_max_radps > 0.0 && turned_rad > turn_allowed_rad ? Reach::kTurned
                                                                         : Reach::kWithin;
}

double PoseGate::margins_between(const Pose3& a, const Pose3& b) const {
  const double moved = (b.translation_m - a.translation_m).norm() / settings_.jump_margin_m;
  const double turned = a.rotation.angularDistance(b.rotation) / settings_.turn_margin_rad;
  return settings_.turn_max_radps > 0.0 ? std::max(moved, turned) : moved;
}

// The smaller distance to the last good pose is not sufficient: vehicles in a line pass the last
// good positions of each other. A body with a swapped name is then closest to such a position for
// one frame.
bool PoseGate::is_back(Duration now, const Pose3& pose) const {
  const Duration usual = (now - candidate_time_) / settings_.usual_divisor;
  return reach(*candidate_, pose, usual) != Reach::kWithin &&
         margins_between(*last_, pose) < margins_between(*candidate_, pose);
}

bool PoseGate::is_repeated(const Pose3& pose) {
  const bool is_same = previous_ && previous_->translation_m == pose.translation_m &&
                       previous_->rotation.coeffs() == pose.rotation.coeffs();
  repetitions_ = is_same ? repetitions_ + 1 : 0;
  previous_ = pose;
  return settings_.stuck_frames > 0 && repetitions_ >= settings_.stuck_frames;
}

Eigen::Vector3d PoseGate::predicted_m(Duration now) const {
  return last_->translation_m + to_seconds(std::min(now - last_time_, kPredictMax)) * velocity_mps_;
}

bool PoseGate::is_near_prediction(Duration now, const Pose3& pose) const {
  return (pose.translation_m - predicted_m(now)).norm() <= settings_.predicted_max_m;
}

bool PoseGate::continues_chain(Duration now, const Pose3& pose) const {
  if (!candidate_ || now - candidate_time_ > settings_.lost_after) {
    return false;
  }
  const Duration passed = now - candidate_time_;
  const Duration reached = is_swap_ ? passed / settings_.usual_divisor : passed;
  return reach(*candidate_, pose, reached) == Reach::kWithin;
}

Verdict PoseGate::accept(Duration now, const Pose3& pose) {
  const double passed_s = last_ ? to_seconds(now - last_time_) : 0.0;
  if (candidate_ && is_accepted(now)) {
    velocity_mps_.setZero();  // the velocity is unknown after a jump
  } else if (passed_s > 0.0) {
    const Eigen::Vector3d measured_mps = (pose.translation_m - last_->translation_m) / passed_s;
    velocity_mps_ += -std::expm1(-passed_s / kVelocityMemory_s) * (measured_mps - velocity_mps_);
    // Frames that arrive in bursts cause impossible speeds.
    const double usual_mps = settings_.speed_max_mps / settings_.usual_divisor;
    const double speed_mps = velocity_mps_.norm();
    velocity_mps_ *= speed_mps > usual_mps ? usual_mps / speed_mps : 1.0;
  }
  last_ = pose;
  last_time_ = now;
  candidate_.reset();
  return Verdict::kGood;
}

bool PoseGate::is_accepted(Duration now) const {
  if (is_swap_) {
    return false;
  }
  return candidate_kind_ == Verdict::kUnconfirmed
             ? candidate_frames_ >= settings_.confirm_frames
             : now - candidate_since_ >= settings_.accept_jump_after;
}

}  // namespace vantage::drivers::vicon
