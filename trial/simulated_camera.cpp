#include "trial/simulated_camera.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "drivers/camera/app/node.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "models/world/world.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "sim/camera/renderer.hpp"

namespace vantage::trial {
namespace {

constexpr int kImageStream = -3;  // of drivers::noise_of()

/// Tag on its body: `body` is the name of a body in TRUTH, or empty for a tag at a fixed pose.
struct MountedTag {
  std::string body;
  sim::PlacedTag tag;  ///< world_from_tag: of the fixed pose, else body_from_tag
};

std::vector<MountedTag> mounted_tags(const scenario::Scenario& scenario,
                                     const scenario::CameraSpec& spec) {
  std::vector<MountedTag> out;
  for (const scenario::TagSpec& each : spec.tags) {
    Result<sim::TagPattern> pattern = sim::tag_pattern(spec.family, each.id);
    if (!pattern.ok()) {
      throw StartupError(scenario.name + ": " + pattern.error().message);
    }
    MountedTag mounted{each.body, {std::move(pattern).value(), each.size_m, {}}};
    mounted.tag.world_from_tag.translation_m.z() = each.height_m;
    if (each.carrier == scenario::TagCarrier::kLandmark) {
      const auto localizer = scenario::parse_localizer(scenario.source_text, scenario.name);
      for (const scenario::LandmarkSpec& landmark : localizer->landmarks) {
        if (landmark.id == each.body_id) {
          mounted.tag.world_from_tag.translation_m.head<2>() = landmark.position_m;
        }
      }
    }
    out.push_back(std::move(mounted));
  }
  return out;
}

class RenderedImages : public drivers::camera::ImageSource {
 public:
  RenderedImages(bus::Bus& bus, const scenario::Scenario& scenario, scenario::CameraSpec spec,
                 const models::CameraModel& camera)
      : spec_(std::move(spec)),
        seed_(scenario.seed),
        world_(scenario.world),
        period_(from_seconds(spec_.rate_hz > 0.0 ? 1.0 / spec_.rate_hz : scenario.planner.step_s)),
        tags_(mounted_tags(scenario, spec_)),
        renderer_(camera) {
    bus.subscribe<models::TruthFrame>(bus::kTruth,
                                      [this](const models::TruthFrame& truth) { on_truth(truth); });
  }

  std::optional<drivers::camera::CapturedImage> next(Time /*now*/) override {
    if (images_.empty()) {
      return std::nullopt;
    }
    drivers::camera::CapturedImage out = std::move(images_.front());
    images_.pop_front();
    return out;
  }
  [[nodiscard]] drivers::camera::SourceCounts counts() const override { return {}; }
  [[nodiscard]] std::string status() const override { return "simulated camera"; }

 private:
  void on_truth(const models::TruthFrame& truth) {
    const std::int64_t period = to_utime(truth.stamp.time) / period_.count();
    const auto find = [&](const std::string& name) {
      return std::find_if(truth.bodies.begin(), truth.bodies.end(),
                          [&](const models::TruthBody& body) { return body.name == name; });
    };
    const auto self = find(spec_.robot);
    if (period == last_period_ || self == truth.bodies.end()) {
      return;
    }
    last_period_ = period;
    std::vector<sim::PlacedTag> placed;
    for (const MountedTag& each : tags_) {
      sim::PlacedTag tag = each.tag;
      if (!each.body.empty()) {
        const auto body = find(each.body);
        if (body == truth.bodies.end()) {
          continue;
        }
        tag.world_from_tag = body->world_from_body * each.tag.world_from_tag;
      }
      const bool is_hidden =
          !models::line_of_sight(world_, self->world_from_body.translation_m.head<2>(),
                                 tag.world_from_tag.translation_m.head<2>());
      if (!is_hidden) {
        placed.push_back(std::move(tag));
      }
    }
    std::mt19937_64 rng = drivers::noise_of(seed_, spec_.robot, kImageStream, truth.stamp.time);
    images_.push_back(
        {truth.stamp.time, renderer_.render(self->world_from_body * spec_.body_from_camera, placed,
                                            sim::ImageQuality{}, rng)});
  }

  scenario::CameraSpec spec_;
  std::uint64_t seed_;
  models::World world_;  ///< whose obstacles hide tags
  Duration period_;
  std::vector<MountedTag> tags_;
  sim::TagRenderer renderer_;
  std::int64_t last_period_ = 0;
  std::deque<drivers::camera::CapturedImage> images_;
};

}  // namespace

std::unique_ptr<bus::Node> simulated_camera(bus::Bus& bus, const bus::Clock& clock,
                                            const scenario::Scenario& scenario,
                                            const scenario::CameraSpec& spec) {
  const models::CameraModel camera = scenario::calibration_of(spec);
  Result<std::unique_ptr<drivers::camera::TagDetector>> detector =
      drivers::camera::make_tag_detector(spec.family);
  if (!detector.ok()) {
    throw StartupError(detector.error().message);
  }
  return std::make_unique<drivers::CameraNode>(
      bus, clock, scenario, spec, camera, std::move(detector).value(),
      std::make_unique<RenderedImages>(bus, scenario, spec, camera));
}

}  // namespace vantage::trial
