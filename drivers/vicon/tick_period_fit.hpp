#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace vantage::drivers::vicon {

/// Arrival of one frame.
struct FrameMark {
  std::int64_t tick = 0;  ///< frame number, or the server's stamp
  double arrival_s = 0.0;
};

/// Estimator of the tick period, the time between two ticks, from arrivals with jitter.
///
/// Jitter only delays frames. The tick period is therefore the slope of a line below all marks that
/// touches two marks: the edge of their lower convex hull across the middle. Late frames at either
/// end do not change the slope. The memory is fixed. When it is full, every second mark is dropped,
/// and the stride between stored frames doubles.
class TickPeriodFit {
 public:
  void restart() { *this = {}; }
  /// Adds a mark; ticks must increase.
  void add(const FrameMark& mark);
  /// Returns the time from the first mark to the last, s.
  [[nodiscard]] double span_s() const;
  /// Returns the time between two ticks, s; nullopt with fewer than kMarksMin marks.
  [[nodiscard]] std::optional<double> tick_s() const;

 private:
  static constexpr std::size_t kMarksMax = 256;
  static constexpr std::size_t kMarksMin = 10;
  std::array<FrameMark, kMarksMax> marks_{};
  std::size_t size_ = 0;
  std::size_t stride_ = 1;   ///< one frame of every `stride_` frames is stored
  std::size_t skipped_ = 0;  ///< number of frames since the last stored frame
};

}  // namespace vantage::drivers::vicon
