#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "sim/camera/tag_scene.hpp"

namespace vantage::sim {

/// Bus node of vantage-camera-emulator: subscribes to TRUTH and writes the images of one robot's
/// simulated camera to the folder that vantage-camera reads. Images are removed after 2 s.
class CameraEmulatorNode : public bus::Node {
 public:
  /// Creates the folder, only accessible to this user, and removes the images in it.
  /// @throws StartupError when the folder cannot be created or belongs to another user
  CameraEmulatorNode(bus::Bus& bus, const bus::Clock& clock, std::unique_ptr<TagScene> scene);
  /// Removes the folder.
  ~CameraEmulatorNode() override;
  CameraEmulatorNode(const CameraEmulatorNode&) = delete;
  CameraEmulatorNode& operator=(const CameraEmulatorNode&) = delete;
  CameraEmulatorNode(CameraEmulatorNode&&) = delete;
  CameraEmulatorNode& operator=(CameraEmulatorNode&&) = delete;

  [[nodiscard]] std::string name() const override { return "CAMERA_EMULATOR_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  /// Removes old images.
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  void on_truth(const models::TruthFrame& truth);

  struct Written {
    Time time{};
    std::string path;
  };

  const bus::Clock& clock_;
  std::unique_ptr<TagScene> scene_;
  std::string robot_;
  std::string folder_;
  Time next_tick_;
  std::deque<Written> written_;
  std::int64_t unwritten_ = 0;
};

/// Returns the node for the camera of `robot`.
/// @throws StartupError if the robot has no camera with the source `simulated`
std::unique_ptr<bus::Node> start_camera_emulator(bus::Bus& bus, const bus::Clock& clock,
                                                 const scenario::Scenario& scenario,
                                                 const std::string& robot);

}  // namespace vantage::sim
