#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/vicon/frame_assembly.hpp"
#include "drivers/vicon/frame_filter.hpp"
#include "scenario/scenario.hpp"
#include "tools/ros2/incoming.hpp"

namespace vantage::tools::ros2 {

struct PoseCounts {
  std::int64_t unreadable = 0;   ///< messages that are damaged or contain impossible numbers
  std::int64_t wrong_frame = 0;  ///< poses in a frame other than the world frame
  std::int64_t stale = 0;        ///< poses with a stamp older than kAgeMax
  std::int64_t early = 0;        ///< poses with a stamp in the future: the clocks differ
};

/// Source of VICON frames from poses on ROS 2 topics, without sockets. The poses pass the same
/// checks as those of a mocap server (FrameFilter).
///
/// The stamp of a message is the capture time, so the clocks of both hosts must agree. Poses with
/// stamps within kSameFrame form one frame; a body without a pose in a frame is occluded.
class PoseSource {
 public:
  static constexpr Duration kAgeMax{500'000};  ///< vehicles need poses within this time
  static constexpr Duration kEarlyMax{5'000};
  static constexpr Duration kSameFrame{1'000};

  /// @param publish  called with each accepted frame, within on_message() or on_time()
  PoseSource(const scenario::Scenario& scenario, std::string world_frame,
             drivers::vicon::FrameFilter::Publish publish);

  void on_message(const scenario::Ros2PoseInput& input, Bytes cdr, drivers::vicon::Moment now);
  /// Passes on a frame that has waited long enough for further poses.
  void on_time(drivers::vicon::Moment now) { assembly_.on_time(now); }

  [[nodiscard]] const PoseCounts& counts() const { return counts_; }
  [[nodiscard]] const drivers::vicon::FrameCounts& frame_counts() const { return filter_.counts(); }

 private:
  void add(const std::string& body, const StampedPose& pose, drivers::vicon::Moment now);

  std::string world_frame_;
  drivers::vicon::FrameFilter filter_;
  drivers::vicon::FrameAssembly assembly_;
  Time frame_stamp_{};
  PoseCounts counts_;
};

}  // namespace vantage::tools::ros2
