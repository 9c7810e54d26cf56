#pragma once

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/camera/camera_model.hpp"
#include "models/camera/image.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/world.hpp"
#include "scenario/camera_spec.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/scenario.hpp"
#include "sim/camera/renderer.hpp"

namespace vantage::sim {

/// Tags of a scenario, as one robot's camera sees them in the simulated world. Obstacles hide tags,
/// but are not drawn.
class TagScene {
 public:
  /// @param landmarks  positions of the landmarks that carry tags
  /// @throws StartupError if the program was built without the AprilTag library, or a tag is not in
  ///         its family
  TagScene(const scenario::Scenario& scenario, scenario::CameraSpec spec,
           const models::CameraModel& camera, const std::vector<scenario::LandmarkSpec>& landmarks);

  /// Returns the image at the time of `truth`; nullopt if `truth` does not contain the robot, or if
  /// an image was already made in the current measurement period. The image depends on the
  /// scenario's seed, the robot and the truth only.
  std::optional<models::GrayImage> image_of(const models::TruthFrame& truth);

  [[nodiscard]] const scenario::CameraSpec& spec() const { return spec_; }

 private:
  /// Tag on a body of TRUTH, or at a fixed pose.
  struct MountedTag {
    std::string body;  ///< empty: the tag is fixed in the world
    PlacedTag tag;     ///< its pose is body_from_tag if the tag is on a body
  };

  scenario::CameraSpec spec_;
  std::uint64_t seed_;
  models::World world_;
  Duration period_;
  std::vector<MountedTag> tags_;
  TagRenderer renderer_;
  std::int64_t last_period_ = 0;
};

}  // namespace vantage::sim
