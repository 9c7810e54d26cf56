#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// The newest mocap frames, from which the poses at the time of a detection are interpolated.
class FrameHistory {
 public:
  static constexpr Duration kGapMax{200'000};  ///< largest gap between frames for interpolation

  /// @param age_max  age up to which frames are kept
  explicit FrameHistory(Duration age_max) : age_max_(age_max) {}

  /// Adds a frame. A frame that does not continue the stored sequence replaces all stored frames:
  /// the mocap system was restarted, or its clock was set.
  void add(std::shared_ptr<const models::MocapFrame> frame);
  /// True if a frame was captured at or after `time`.
  [[nodiscard]] bool reaches(Time time) const;

  struct Found {
    models::MocapFrame frame;
    std::vector<models::InputRef> inputs;  ///< frames used for the interpolation
  };
  /// Returns the bodies at `time`, interpolated between two frames at most kGapMax apart; nullopt
  /// if there are no such frames.
  [[nodiscard]] std::optional<Found> at(Time time) const;

 private:
  Duration age_max_;
  std::deque<std::shared_ptr<const models::MocapFrame>> frames_;
};

}  // namespace vantage::drivers
