#include "trial/simulated_camera.hpp"

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "drivers/camera/app/node.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "sim/camera/tag_scene.hpp"

namespace vantage::trial {
namespace {

/// Source of the images that a scene renders from TRUTH.
class RenderedImages : public drivers::camera::ImageSource {
 public:
  RenderedImages(bus::Bus& bus, std::unique_ptr<sim::TagScene> scene) : scene_(std::move(scene)) {
    bus.subscribe<models::TruthFrame>(bus::kTruth, [this](const models::TruthFrame& truth) {
      if (std::optional<models::GrayImage> image = scene_->image_of(truth)) {
        images_.push_back({truth.stamp.time, *std::move(image)});
      }
    });
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
  std::unique_ptr<sim::TagScene> scene_;
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
  const auto localizer = scenario::parse_localizer(scenario.source_text, scenario.name);
  auto scene = std::make_unique<sim::TagScene>(
      scenario, spec, camera,
      localizer ? localizer->landmarks : std::vector<scenario::LandmarkSpec>());
  return std::make_unique<drivers::CameraNode>(
      bus, clock, scenario, spec, camera, std::move(detector).value(),
      std::make_unique<RenderedImages>(bus, std::move(scene)));
}

}  // namespace vantage::trial
