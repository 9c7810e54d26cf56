#include "drivers/vehicle/body_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace vantage::drivers {
namespace {

constexpr double kAccelerationSigmaMps2 = 5.0;
constexpr double kPositionSigmaM = 0.001;
constexpr double kStartVelocitySigmaMps = 1.0;
constexpr double kJumpM = 0.3;  // m; allowance beyond the distance at maximum speed
constexpr double kJumpRad = 0.8;
constexpr double kTurnMaxRadps = 8.0;
constexpr double kSamePositionM = 0.2;
constexpr double kGapMaxS = 0.5;  // s; the filter restarts after a longer gap
constexpr Duration kStuck = std::chrono::milliseconds(500);
constexpr Duration kConfirmation = std::chrono::milliseconds(500);

bool is_possible(const Pose3& pose) {
  return pose.translation_m.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < 1e-3;
}

}  // namespace

BodyVerdict BodyTracker::update(const models::MocapFrame& frame, Time captured, Time now,
                                bool is_resting) {
  const models::MocapBody* const body = frame.find(name_);
  if (body == nullptr || body->occluded) {
    return BodyVerdict::kUnseen;
  }
  const Pose3& pose = body->world_from_body;
  if (!is_possible(pose)) {
    return BodyVerdict::kImpossible;
  }
  if (!state_ || frame.stamp.run_id != run_id_) {
    // Uses arrival times, since another run may have another clock.
    const bool is_elsewhere =
        state_ && is_jump(pose, state_->capture + std::max(Duration{}, now - arrival_));
    if (is_elsewhere && !is_resting) {
      return BodyVerdict::kJumped;
    }
    const auto resets = static_cast<std::uint8_t>(state_ ? state_->resets + is_elsewhere : 0);
    start(pose, captured);
    state_->resets = resets;
  } else if (captured <= state_->capture) {
    return BodyVerdict::kOutOfOrder;
  } else if (is_jump(pose, captured)) {
    const bool is_confirming =
        candidate_ && now - candidate_->newest < kConfirmation &&
        (candidate_->pose.translation_m - pose.translation_m).norm() < kSamePositionM;
    if (!is_confirming) {
      candidate_ = Candidate{pose, now, now};
    }
    candidate_->newest = now;
    if (!is_resting || now - candidate_->since < kConfirmation) {
      return BodyVerdict::kJumped;
    }
    const auto resets = static_cast<std::uint8_t>(state_->resets + 1);
    start(pose, captured);
    state_->resets = resets;
  } else {
    const bool is_same = pose.translation_m == state_->world_from_body.translation_m &&
                         pose.rotation.coeffs() == state_->world_from_body.rotation.coeffs();
    if (is_same && !is_resting && captured - changed_ > kStuck) {
      return BodyVerdict::kRepeated;
    }
    changed_ = is_same ? changed_ : captured;
    filter(pose, captured);
  }
  candidate_.reset();
  run_id_ = frame.stamp.run_id;
  arrival_ = now;
  return BodyVerdict::kTaken;
}

std::optional<Duration> BodyTracker::age(Time now) const {
  return state_ ? std::optional(now - arrival_) : std::nullopt;
}

bool BodyTracker::is_jump(const Pose3& pose, Time capture) const {
  const double gap_s = std::max(0.0, to_seconds(capture - state_->capture));
  const double moved_m = (pose.translation_m - state_->world_from_body.translation_m).norm();
  const double turned_rad = state_->world_from_body.rotation.angularDistance(pose.rotation);
  return moved_m > kJumpM + speed_max_mps_ * gap_s || turned_rad > kJumpRad + kTurnMaxRadps * gap_s;
}

void BodyTracker::start(const Pose3& pose, Time capture) {
  BodyState fresh;
  fresh.capture = capture;
  fresh.world_from_body = pose;
  fresh.velocity_sigma_mps = kStartVelocitySigmaMps;
  state_ = fresh;
  changed_ = capture;
  filtered_position_m_ = pose.translation_m;
  covariance_ << kPositionSigmaM * kPositionSigmaM, 0.0, 0.0,
      kStartVelocitySigmaMps * kStartVelocitySigmaMps;
}

void BodyTracker::filter(const Pose3& pose, Time capture) {
  const double dt_s = to_seconds(capture - state_->capture);
  if (dt_s > kGapMaxS) {
    const std::uint8_t resets = state_->resets;
    start(pose, capture);
    state_->resets = resets;
    return;
  }
  Eigen::Matrix2d A;
  A << 1.0, dt_s, 0.0, 1.0;
  const Eigen::Vector2d g(0.5 * dt_s * dt_s, dt_s);
  const double q = kAccelerationSigmaMps2 * kAccelerationSigmaMps2;
  const Eigen::Matrix2d P = A * covariance_ * A.transpose() + q * g * g.transpose();
  const double s = P(0, 0) + kPositionSigmaM * kPositionSigmaM;
  const Eigen::Vector2d k = P.col(0) / s;
  covariance_ = P - k * s * k.transpose();

  const Eigen::Vector3d predicted_m = filtered_position_m_ + dt_s * state_->velocity_world_mps;
  const Eigen::Vector3d innovation_m = pose.translation_m - predicted_m;
  filtered_position_m_ = predicted_m + k(0) * innovation_m;
  state_->velocity_world_mps += k(1) * innovation_m;
  state_->velocity_sigma_mps = std::sqrt(covariance_(1, 1));
  state_->world_from_body = pose;
  state_->capture = capture;
}

}  // namespace vantage::drivers
