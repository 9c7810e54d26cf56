#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/vicon/session.hpp"

namespace vantage::drivers::vicon {

/// Puts a frame together from pieces that do not say how many they are: datagrams with one frame
/// number, or messages with one time stamp.
///
/// A frame is handed on as soon as it has every body of the frame before, else when the next one
/// begins or kPatience after its first piece; the first of all waits, too. So a body that vanishes
/// costs one frame kPatience of delay, and a system that stands costs none.
class FrameAssembly {
 public:
  static constexpr Duration kPatience{4'000};

  explicit FrameAssembly(FrameSink sink) : sink_(std::move(sink)) {}

  void clear();
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] SeenFrame& frame() { return frame_; }
  /// Starts a frame; the one before, if it is still open, is handed on first.
  SeenFrame& begin(Moment arrival);
  /// Call after each batch of pieces.
  void hand_on_if_whole();
  void on_time(Moment now);
  [[nodiscard]] std::optional<Duration> next_wake() const;
  /// The next frame waits for this body.
  void expect(std::string_view name);
  /// The same, of a body whose piece came after its frame was handed on; frame() has it from now.
  void expect_also(std::string_view name);

 private:
  void hand_on();

  FrameSink sink_;
  SeenFrame frame_;
  bool is_open_ = false;
  bool is_first_ = true;
  std::vector<std::string> expected_;  ///< memory is reused; the first expected_size_ count
  std::size_t expected_size_ = 0;
};

}  // namespace vantage::drivers::vicon
