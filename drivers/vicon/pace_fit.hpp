#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace vantage::drivers::vicon {

/// When a frame arrived.
struct FrameMark {
  std::int64_t tick = 0;  ///< frame number, or stamp of its server
  double arrival_s = 0.0;
};

/// Computes the time between two ticks from arrivals that jitter.
///
/// Jitter only makes frames later, so the pace is the slope of the line that lies under all marks
/// and touches two of them: the edge of their lower convex hull across the middle. Frames that come
/// late at one of the ends do not change it. Memory is fixed: when it is full, every second mark is
/// dropped, and from then on every second frame is kept.
class PaceFit {
 public:
  void restart() { *this = {}; }
  /// Ticks must grow.
  void add(const FrameMark& mark);
  /// Time from the first mark to the last.
  [[nodiscard]] double span_s() const;
  /// Time between two ticks, s; nullopt before there are kMarksMin marks.
  [[nodiscard]] std::optional<double> tick_s() const;

 private:
  static constexpr std::size_t kMarksMax = 256;
  static constexpr std::size_t kMarksMin = 10;
  std::array<FrameMark, kMarksMax> marks_{};
  std::size_t size_ = 0;
  std::size_t stride_ = 1;   ///< one of this number of frames is kept
  std::size_t skipped_ = 0;  ///< since the last one that was kept
};

}  // namespace vantage::drivers::vicon
