#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/latency_record.hpp"
#include "core/time.hpp"
#include "drivers/camera/image_source.hpp"
#include "drivers/camera/tag_detector.hpp"
#include "drivers/camera/tag_observer.hpp"
#include "drivers/sensor/frame_history.hpp"
#include "drivers/sensor/jam_watch.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/mocap_clock.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Bus node of vantage-camera for one robot: detects tags in images, subscribes to VICON and
/// ATTACK, publishes MEASUREMENT_R.
///
/// A measurement has the time of the middle of the exposure. The robot's pose at this time is
/// interpolated between two mocap frames, so an image waits until a later frame has arrived. Errors
/// of successive images are not independent, so only one image per measurement period is
/// processed: the first one later than 1/10 period before the start of that period.
class CameraNode : public bus::Node {
 public:
  static constexpr Duration kAgeMax{1'000'000};  ///< older images are dropped
  static constexpr Duration kEarlyMax{5'000};    ///< images with later stamps are dropped

  /// @throws UsageError for a robot that is not in the scenario
  CameraNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
             const scenario::CameraSpec& spec, const models::CameraModel& camera,
             std::unique_ptr<camera::TagDetector> detector,
             std::unique_ptr<camera::ImageSource> source);

  [[nodiscard]] std::string name() const override { return "CAMERA_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  /// Tags of one image that waits for a pose.
  struct Waiting {
    Time time{};
    std::vector<camera::SeenTag> tags;
  };

  void on_frame(const std::shared_ptr<const models::MocapFrame>& received);
  /// Processes the images that have arrived, then publishes the measurements for which the robot's
  /// pose is known.
  void work(Time now);
  void process(const camera::CapturedImage& captured, Time now);
  void publish(const Waiting& seen, Time now);

  static constexpr std::size_t kWaitingMax = 16;

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string robot_;
  Duration period_;
  camera::TagObserver observer_;
  std::unique_ptr<camera::TagDetector> detector_;
  std::unique_ptr<camera::ImageSource> source_;
  std::string status_;  ///< last printed status of the source
  Time next_tick_;
  models::MocapClock mocap_clock_;
  FrameHistory frames_{kAgeMax};
  JamWatch jam_watch_;
  std::deque<Waiting> waiting_;
  std::optional<Time> last_image_;
  std::int64_t last_period_ = 0;  ///< number of the period of the last processed image
  LatencyRecord processing_;      ///< time from an image's arrival to the detection of its tags
  std::int64_t images_ = 0;
  std::int64_t late_ = 0;
  std::int64_t early_ = 0;
  std::int64_t out_of_order_ = 0;
  std::int64_t wrong_size_ = 0;
  std::int64_t overflowed_ = 0;
  std::int64_t without_pose_ = 0;
};

}  // namespace vantage::drivers
