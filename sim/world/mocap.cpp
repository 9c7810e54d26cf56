#include "sim/world/mocap.hpp"

#include <utility>

#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::sim {

MocapCamera::MocapCamera(const scenario::MocapSpec& spec, std::uint64_t seed)
    : spec_(spec), latency_(from_seconds(spec.latency_s)), rng_(random_stream(seed, "mocap")) {
  require(spec.rate_hz > 0.0 && spec.rate_hz <= 1000.0, "mocap: rate_hz must be in (0, 1000]");
  require(spec.position_sigma_m >= 0.0 && spec.yaw_sigma_rad >= 0.0 && spec.latency_s >= 0.0,
          "mocap: noise and latency must not be negative");
  period_ = from_seconds(1.0 / spec.rate_hz);
}

Time MocapCamera::capture_at_or_after(Time time) const {
  const std::int64_t periods = (to_utime(time) + period_.count() - 1) / period_.count();
  return from_utime(periods * period_.count());
}

models::MocapFrame MocapCamera::capture(const models::TruthFrame& truth) {
  std::normal_distribution<double> normal;
  models::MocapFrame frame;
  frame.stamp.time = truth.stamp.time;
  frame.arrival = truth.stamp.time + latency_;
  frame.frame_number = to_utime(truth.stamp.time) / period_.count();
  frame.bodies.reserve(truth.bodies.size());
  for (const models::TruthBody& body : truth.bodies) {
    models::MocapBody seen;
    seen.name = body.name;
    Eigen::Vector3d noise_m;
    for (double& component : noise_m) {
      component = spec_.position_sigma_m * normal(rng_);
    }
    const double yaw_noise_rad = spec_.yaw_sigma_rad * normal(rng_);
    seen.world_from_body.translation_m = body.world_from_body.translation_m + noise_m;
    seen.world_from_body.rotation =
        (Eigen::AngleAxisd(yaw_noise_rad, Eigen::Vector3d::UnitZ()) * body.world_from_body.rotation)
            .normalized();
    frame.bodies.push_back(std::move(seen));
  }
  return frame;
}

}  // namespace vantage::sim
