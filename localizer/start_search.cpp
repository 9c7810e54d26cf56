#include "localizer/start_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

constexpr double kMemoryS = 20.0;   // older sightings are ignored
constexpr double kDriftMps = 0.02;  // assumed growth of the odometry's position error
constexpr double kPairDistanceMinM = 0.3;
constexpr double kAgreeSigma = 3.0;
constexpr int kAgreeingMin = 4;
constexpr double kYawSigmaMaxRad = 0.12;
/// Factor of the fitted variances, because the errors of consecutive sightings are correlated.
constexpr double kVarianceFactor = 6.0;

}  // namespace

void StartSearch::clear() {
  count_ = 0;
  next_ = 0;
}

void StartSearch::advance(double duration_s, const Eigen::Vector3d& increment) {
  now_s_ += duration_s;
  odom_from_body_ = odom_from_body_ * Pose2{increment.x(), increment.y(), increment.z()};
}

double StartSearch::sigma_m(const Anchor& anchor) const {
  return anchor.sigma_m + kDriftMps * (now_s_ - anchor.at_s);
}

int StartSearch::agreeing(const Pose2& world_from_odom) const {
  int count = 0;
  for (int k = 0; k < count_; ++k) {
    const Anchor& anchor = anchors_[static_cast<std::size_t>(k)];
    const double miss_m = (world_from_odom * anchor.point_odom_m - anchor.point_world_m).norm();
    count += now_s_ - anchor.at_s < kMemoryS && miss_m < kAgreeSigma * sigma_m(anchor) ? 1 : 0;
  }
  return count;
}

std::optional<PoseBelief> StartSearch::fit(const Pose2& world_from_odom) const {
  // Computes the weighted least-squares alignment of the agreeing points.
  double weight = 0.0;
  Eigen::Vector2d mean_odom_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_world_m = Eigen::Vector2d::Zero();
  const auto each = [&](const auto& use) {
    for (int k = 0; k < count_; ++k) {
      const Anchor& anchor = anchors_[static_cast<std::size_t>(k)];
      const double miss_m = (world_from_odom * anchor.point_odom_m - anchor.point_world_m).norm();
      if (now_s_ - anchor.at_s < kMemoryS && miss_m < kAgreeSigma * sigma_m(anchor)) {
        use(anchor, 1.0 / (sigma_m(anchor) * sigma_m(anchor)));
      }
    }
  };
  each([&](const Anchor& anchor, double w) {
    weight += w;
    mean_odom_m += w * anchor.point_odom_m;
    mean_world_m += w * anchor.point_world_m;
  });
  mean_odom_m /= weight;
  mean_world_m /= weight;
  double cosine = 0.0;
  double sine = 0.0;
  double spread = 0.0;
  each([&](const Anchor& anchor, double w) {
    const Eigen::Vector2d p = anchor.point_odom_m - mean_odom_m;
    const Eigen::Vector2d q = anchor.point_world_m - mean_world_m;
    cosine += w * p.dot(q);
    sine += w * (p.x() * q.y() - p.y() * q.x());
    spread += w * p.squaredNorm();
  });
  const double yaw_variance = kVarianceFactor / spread;
  if (!(yaw_variance < kYawSigmaMaxRad * kYawSigmaMaxRad)) {
    return std::nullopt;
  }
  Pose2 fitted{0.0, 0.0, std::atan2(sine, cosine)};
  const Eigen::Vector2d origin_m = mean_world_m - fitted * mean_odom_m;
  fitted.x_m = origin_m.x();
  fitted.y_m = origin_m.y();

  PoseBelief belief;
  belief.world_from_body = fitted * odom_from_body_;
  // The body has a lever arm from the mean of the points, so its position depends on the yaw.
  const Eigen::Vector2d lever_m = belief.world_from_body.position_m() - mean_world_m;
  Eigen::Matrix3d by_fit = Eigen::Matrix3d::Identity();
  by_fit(0, 2) = -lever_m.y();
  by_fit(1, 2) = lever_m.x();
  const Eigen::Vector3d variances(kVarianceFactor / weight, kVarianceFactor / weight, yaw_variance);
  belief.covariance = by_fit * variances.asDiagonal() * by_fit.transpose();
  return belief;
}

std::optional<PoseBelief> StartSearch::observe(const scenario::LocalizerSpec& spec, int robot,
                                               std::span<const models::Sighting> sightings) {
  const scenario::SightingSpec& camera = spec.robots[static_cast<std::size_t>(robot)].sightings;
  const scenario::SightingNoiseSpec& noise = spec.sighting_noise;
  int best = 0;
  Pose2 best_world_from_odom;
  for (const models::Sighting& sighting : sightings) {
    const auto landmark =
        std::find_if(spec.landmarks.begin(), spec.landmarks.end(),
                     [&](const scenario::LandmarkSpec& each) { return each.id == sighting.id; });
    if (landmark == spec.landmarks.end()) {
      continue;
    }
    const Eigen::Vector2d body_m = sighted_point_m(camera, sighting.range_m, sighting.bearing_rad);
    const double d = body_m.norm();
    const double across_m = d * std::hypot(noise.bearing_sigma_rad, noise.frame_bearing_sigma_rad) +
                            noise.across_sigma_m;
    const Anchor newest{now_s_, sighting.id, odom_from_body_ * body_m, landmark->position_m,
                        noise.range_sigma_m + noise.range_sigma_per_m * d * d + across_m};
    anchors_[static_cast<std::size_t>(next_)] = newest;
    next_ = (next_ + 1) % kSightingsMax;
    count_ = std::min(count_ + 1, kSightingsMax);
    for (int k = 0; k < count_; ++k) {
      const Anchor& other = anchors_[static_cast<std::size_t>(k)];
      const Eigen::Vector2d world_m = newest.point_world_m - other.point_world_m;
      const Eigen::Vector2d odom_m = newest.point_odom_m - other.point_odom_m;
      if (other.id == newest.id || now_s_ - other.at_s >= kMemoryS ||
          world_m.norm() < kPairDistanceMinM ||
          std::abs(world_m.norm() - odom_m.norm()) >
              kAgreeSigma * (sigma_m(newest) + sigma_m(other))) {
        continue;
      }
      Pose2 world_from_odom{
          0.0, 0.0,
          wrap_to_pi(std::atan2(world_m.y(), world_m.x()) - std::atan2(odom_m.y(), odom_m.x()))};
      const Eigen::Vector2d origin_m = newest.point_world_m - world_from_odom * newest.point_odom_m;
      world_from_odom.x_m = origin_m.x();
      world_from_odom.y_m = origin_m.y();
      if (const int agree = agreeing(world_from_odom); agree > best) {
        best = agree;
        best_world_from_odom = world_from_odom;
      }
    }
  }
  return best >= kAgreeingMin ? fit(best_world_from_odom) : std::nullopt;
}

}  // namespace vantage::localizer
