#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/vicon/session.hpp"

namespace vantage::drivers::vicon {

/// Assembly of a frame from an unknown number of pieces: datagrams with one frame number, or
/// messages with one stamp.
///
/// A frame is passed on as soon as it contains each body of the previous frame. Otherwise it is
/// passed on when the next frame begins, or kPatience after its first piece. This also applies to
/// the first frame. A body that vanishes thus delays one frame by kPatience.
class FrameAssembly {
 public:
  static constexpr Duration kPatience{4'000};

  explicit FrameAssembly(FrameSink sink) : sink_(std::move(sink)) {}

  void clear();
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] SeenFrame& frame() { return frame_; }
  /// Starts a frame; first passes on the previous frame if it is still being assembled.
  SeenFrame& begin(Moment arrival);
  /// Passes on the frame if it is complete. Call it after each batch of pieces.
  void pass_on_if_complete();
  void on_time(Moment now);
  [[nodiscard]] std::optional<Duration> next_wake() const;
  /// Makes the next frame wait for this body.
  void expect(std::string_view name);
  /// Adds to frame() a body that arrived after its frame was passed on, and makes the next frame
  /// wait for this body.
  void expect_late(std::string_view name);

 private:
  void pass_on();

  FrameSink sink_;
  SeenFrame frame_;
  bool is_open_ = false;
  bool is_first_ = true;
  /// names of the bodies for which a frame waits; the first expected_size_ entries are valid
  std::vector<std::string> expected_;
  std::size_t expected_size_ = 0;
};

}  // namespace vantage::drivers::vicon
