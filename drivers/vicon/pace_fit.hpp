#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace vantage::drivers::vicon {

/// Arrival of a frame.
struct FrameMark {
  std::int64_t tick = 0;  ///< frame number, or the server's stamp
  double arrival_s = 0.0;
};

/// Estimator of the time between two ticks from arrivals with jitter.
///
/// Jitter only delays frames. The pace is therefore the slope of the line below all marks that
/// touches two of them: the edge of their lower convex hull across the middle. Late frames at one
/// of the ends do not change it. Memory is fixed: when it is full, every second mark is dropped,
/// and from then on every second frame is kept.
class PaceFit {
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
  std::size_t stride_ = 1;   ///< one of this number of frames is kept
  std::size_t skipped_ = 0;  ///< frames since the last one kept
};

}  // namespace vantage::drivers::vicon
