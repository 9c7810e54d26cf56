#include "sim/localisation/landmark_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "core/pose.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kReportedRangeMinM = 0.01;  // m; minimum, because a range is positive

const models::TruthBody* find(const models::TruthFrame& truth, const std::string& name) {
  const auto body = std::find_if(truth.bodies.begin(), truth.bodies.end(),
                                 [&](const auto& each) { return each.name == name; });
  return body == truth.bodies.end() ? nullptr : &*body;
}

}  // namespace

LandmarkSensor::LandmarkSensor(const scenario::LocalizerSpec& spec, int robot,
                               const models::World& world, std::uint64_t seed)
    : spec_(spec),
      robot_(index(robot)),
      world_(world),
      rng_(random_stream(seed, "sightings:" + spec.robots[robot_].name)) {}

std::vector<models::Sighting> LandmarkSensor::look(const models::TruthFrame& truth) {
  const scenario::SightingNoiseSpec& noise = spec_.sighting_noise;
  const scenario::SimulatedSightingsSpec& sensor = spec_.simulation->sightings;
  const scenario::SightingSpec& law = spec_.robots[robot_].sightings;
  std::vector<models::Sighting> seen;
  const models::TruthBody* const self = find(truth, spec_.robots[robot_].name);
  if (self == nullptr) {
    return seen;
  }
  const Pose2 world_from_sensor = flatten(self->world_from_body) * Pose2{law.forward_m, 0.0, 0.0};
  const double shared_rad = sensor.noise_scale * noise.frame_bearing_sigma_rad * normal();
  const auto add = [&](int id, const Eigen::Vector2d& point_m, double point_sigma_m) {
    // Drawn in statements: compilers evaluate the arguments of a call in different orders.
    const double error_y = normal();
    const double error_x = normal();
    const Eigen::Vector2d error(error_x, error_y);
    const double range_error = normal();
    const double bearing_error = normal();
    const bool is_detected =
        std::uniform_real_distribution<double>()(rng_) < sensor.detection_probability;
    const Eigen::Vector2d p_m =
        inverse(world_from_sensor) * Eigen::Vector2d(point_m + point_sigma_m * error);
    const double d = p_m.norm();
    const double bearing_rad = std::atan2(p_m.y(), p_m.x());
    if (!is_detected || d < sensor.range_min_m || d > sensor.range_max_m ||
        std::abs(bearing_rad) > 0.5 * sensor.fov_rad ||
        !models::line_of_sight(world_, world_from_sensor.position_m(), point_m)) {
      return;
    }
    const double range_sigma_m =
        sensor.noise_scale * (noise.range_sigma_m + noise.range_sigma_per_m * d * d);
    const double bearing_sigma_rad =
        sensor.noise_scale * std::hypot(noise.bearing_sigma_rad, noise.across_sigma_m / d);
    const double along_m = law.range_is_depth ? d * std::cos(bearing_rad - law.axis_rad) : d;
    seen.push_back(
        {truth.stamp.time + from_seconds(law.stamp_delay_s), id,
         std::max(law.range_scale * along_m + law.range_offset_m + range_sigma_m * range_error,
                  kReportedRangeMinM),
         wrap_to_pi(bearing_rad + law.bearing_offset_rad + shared_rad +
                    bearing_sigma_rad * bearing_error)});
  };
  for (const scenario::LandmarkSpec& landmark : spec_.landmarks) {
    add(landmark.id, landmark.position_m, 0.0);
  }
  for (std::size_t mate = 0; mate < spec_.robots.size(); ++mate) {
    const models::TruthBody* const body = find(truth, spec_.robots[mate].name);
    if (mate != robot_ && body != nullptr) {
      add(spec_.robots[mate].id, flatten(body->world_from_body).position_m(),
          sensor.noise_scale * noise.teammate_sigma_m);
    }
  }
  return seen;
}

}  // namespace vantage::sim
