#include "sim/camera/tag_scene.hpp"

#include <algorithm>
#include <utility>

#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::sim {

TagScene::TagScene(const scenario::Scenario& scenario, scenario::CameraSpec spec,
                   const models::CameraModel& camera,
                   const std::vector<scenario::LandmarkSpec>& landmarks)
    : spec_(std::move(spec)),
      seed_(scenario.seed),
      world_(scenario.world),
      period_(from_seconds(spec_.rate_hz > 0.0 ? 1.0 / spec_.rate_hz : scenario.planner.step_s)),
      renderer_(camera) {
  for (const scenario::TagSpec& each : spec_.tags) {
    Result<TagPattern> pattern = tag_pattern(spec_.family, each.id);
    if (!pattern.ok()) {
      throw StartupError(scenario.name + ": " + pattern.error().message);
    }
    MountedTag mounted{each.body, {std::move(pattern).value(), each.size_m, {}}};
    mounted.tag.world_from_tag.translation_m.z() = each.height_m;
    for (const scenario::LandmarkSpec& landmark : landmarks) {
      if (each.carrier == scenario::TagCarrier::kLandmark && landmark.id == each.body_id) {
        mounted.tag.world_from_tag.translation_m.head<2>() = landmark.position_m;
      }
    }
    tags_.push_back(std::move(mounted));
  }
}

std::optional<models::GrayImage> TagScene::image_of(const models::TruthFrame& truth) {
  const std::int64_t period = to_utime(truth.stamp.time) / period_.count();
  const auto find = [&](const std::string& name) {
    return std::find_if(truth.bodies.begin(), truth.bodies.end(),
                        [&](const models::TruthBody& body) { return body.name == name; });
  };
  const auto self = find(spec_.robot);
  if (period == last_period_ || self == truth.bodies.end()) {
    return std::nullopt;
  }
  last_period_ = period;
  std::vector<PlacedTag> placed;
  for (const MountedTag& each : tags_) {
    PlacedTag tag = each.tag;
    if (!each.body.empty()) {
      const auto body = find(each.body);
      if (body == truth.bodies.end()) {
        continue;
      }
      tag.world_from_tag = body->world_from_body * each.tag.world_from_tag;
    }
    if (models::line_of_sight(world_, self->world_from_body.translation_m.head<2>(),
                              tag.world_from_tag.translation_m.head<2>())) {
      placed.push_back(std::move(tag));
    }
  }
  std::mt19937_64 rng = random_stream(
      seed_, "image " + spec_.robot + " " + std::to_string(to_utime(truth.stamp.time)));
  return renderer_.render(self->world_from_body * spec_.body_from_camera, placed, ImageQuality{},
                          rng);
}

}  // namespace vantage::sim
