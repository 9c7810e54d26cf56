#include "drivers/camera/tag_observer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "drivers/sensor/detected_position.hpp"

namespace vantage::drivers::camera {
namespace {

// Smallest accepted contrast of a tag's bits, in grey levels of 255. Random patterns that the
// library mistakes for tags have a lower contrast.
constexpr double kMarginMin = 12.0;
constexpr double kHorizontalMin_m = 1e-6;

SeenTag seen_tag(const scenario::TagSpec& tag, const scenario::CameraSpec& spec,
                 const TagPoses& poses, const TagPosition& position) {
  SeenTag out;
  out.tag = tag;
  out.body_from_tag = spec.body_from_camera * poses.best.camera_from_tag;
  out.position_body_m = spec.body_from_camera * position.position_m;
  const Eigen::Matrix3d turn = spec.body_from_camera.rotation.toRotationMatrix();
  // An error of the attitude by the angles a moves the point p by a × p.
  const Eigen::Vector3d p = turn * position.position_m;
  const double attitude2 = spec.attitude_sigma_rad * spec.attitude_sigma_rad;
  out.covariance_body_m2 =
      turn * position.covariance_m2 * turn.transpose() +
      attitude2 * (p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose());
  const Eigen::Vector2d flat_m = out.position_body_m.head<2>();
  out.range_m = flat_m.norm();
  out.bearing_rad = std::atan2(flat_m.y(), flat_m.x());
  const double range_m = std::max(out.range_m, kHorizontalMin_m);
  const Eigen::Vector2d along = flat_m / range_m;
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Matrix2d flat_m2 = out.covariance_body_m2.topLeftCorner<2, 2>();
  out.range_variance_m2 = along.dot(flat_m2 * along);
  out.bearing_variance_rad2 = across.dot(flat_m2 * across) / (range_m * range_m);
  return out;
}

}  // namespace

TagObserver::TagObserver(scenario::CameraSpec spec, const models::CameraModel& camera,
                         const models::SensorModel& sensor, int position_dim)
    : spec_(std::move(spec)), camera_(camera), sensor_(sensor), position_dim_(position_dim) {}

std::vector<SeenTag> TagObserver::observe(const std::vector<DetectedTag>& tags) {
  std::vector<SeenTag> out;
  for (const DetectedTag& each : tags) {
    const auto known =
        std::find_if(spec_.tags.begin(), spec_.tags.end(),
                     [&](const scenario::TagSpec& tag) { return tag.id == each.id; });
    if (known == spec_.tags.end()) {
      ++counts_.unknown;
      continue;
    }
    if (each.hamming > spec_.hamming_max || each.margin < kMarginMin) {
      ++counts_.misread;
      continue;
    }
    const auto has_id = [&](const DetectedTag& other) { return other.id == each.id; };
    if (std::count_if(tags.begin(), tags.end(), has_id) > 1) {
      ++counts_.duplicate;
      continue;
    }
    if (!is_inside(camera_, each.corners_pixels)) {
      ++counts_.at_border;
      continue;
    }
    const std::optional<TagPoses> poses =
        estimate_poses(camera_, known->size_m, each.corners_pixels, spec_.corner_sigma_pixels);
    if (!poses) {
      ++counts_.bad_fit;
      continue;
    }
    const PositionOrFault found = position_of(*poses, spec_.corner_sigma_pixels);
    if (!found.position) {
      ++(found.fault == PositionFault::kAmbiguous ? counts_.ambiguous : counts_.bad_fit);
      continue;
    }
    out.push_back(seen_tag(*known, spec_, *poses, *found.position));
  }
  return out;
}

void TagObserver::add_targets(const std::vector<SeenTag>& tags, const Pose3& world_from_body,
                              models::RobotMeasurement& out) {
  const Eigen::Matrix3d turn = world_from_body.rotation.toRotationMatrix();
  for (const SeenTag& each : tags) {
    if (each.tag.carrier != scenario::TagCarrier::kTarget) {
      continue;
    }
    const auto made =
        measurement_at(sensor_, out.viewpoint, world_from_body * each.position_body_m,
                       turn * each.covariance_body_m2 * turn.transpose(), position_dim_);
    if (!made) {
      ++counts_.out_of_view;
      continue;
    }
    out.detections.push_back({each.tag.body_id, *made});
  }
}

std::vector<models::Sighting> TagObserver::sightings(const std::vector<SeenTag>& tags, Time time) {
  std::vector<models::Sighting> out;
  for (const SeenTag& each : tags) {
    if (each.tag.carrier != scenario::TagCarrier::kTarget) {
      out.push_back({time, each.tag.body_id, each.range_m, each.bearing_rad});
    }
  }
  return out;
}

}  // namespace vantage::drivers::camera
