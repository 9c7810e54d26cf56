#include "localizer/commanded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::localizer {

bool CommandedMotion::command(Time time, double speed_mps, double turn_radps) {
  if (time < newest_) {
    return false;
  }
  newest_ = time;
  if (count_ == kCommandsMax) {
    first_ = (first_ + 1) % kCommandsMax;
    --count_;
  }
  waiting_[(first_ + count_) % kCommandsMax] = {time + from_seconds(drive_.delay_s), speed_mps,
                                                turn_radps};
  ++count_;
  return true;
}

void CommandedMotion::drive_for(double duration_s, Eigen::Vector3d& motion) {
  // The difference from the command decays exponentially; its mean over `duration_s` is `share` of
  // its initial value.
  double mean_mps = wanted_mps_;
  double mean_radps = wanted_radps_;
  if (drive_.lag_s > 0.0) {
    const double keep = std::exp(-duration_s / drive_.lag_s);
    const double share = drive_.lag_s * (1.0 - keep) / duration_s;
    mean_mps += share * (speed_mps_ - wanted_mps_);
    mean_radps += share * (turn_radps_ - wanted_radps_);
    speed_mps_ = wanted_mps_ + keep * (speed_mps_ - wanted_mps_);
    turn_radps_ = wanted_radps_ + keep * (turn_radps_ - wanted_radps_);
  } else {
    speed_mps_ = wanted_mps_;
    turn_radps_ = wanted_radps_;
  }
  const bool is_moving = mean_mps != 0.0 || mean_radps != 0.0;
  const double forward_m = drive_.speed_scale * mean_mps * duration_s;
  const double turn_rad =
      (drive_.turn_scale * mean_radps + (is_moving ? drive_.turn_bias_radps : 0.0)) * duration_s;
  const double middle_rad = motion.z() + 0.5 * turn_rad;
  motion +=
      Eigen::Vector3d(forward_m * std::cos(middle_rad), forward_m * std::sin(middle_rad), turn_rad);
}

Eigen::Vector3d CommandedMotion::advance_to(Time time) {
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  if (!is_started_) {
    is_started_ = true;
    now_ = time;
  }
  while (now_ < time) {
    while (count_ > 0 && waiting_[first_].acts_at <= now_) {
      wanted_mps_ = waiting_[first_].speed_mps;
      wanted_radps_ = waiting_[first_].turn_radps;
      first_ = (first_ + 1) % kCommandsMax;
      --count_;
    }
    const Time until = count_ > 0 ? std::min(time, waiting_[first_].acts_at) : time;
    drive_for(to_seconds(until - now_), motion);
    now_ = until;
  }
  return motion;
}

}  // namespace vantage::localizer
