#include "experiments/sweep/progress.hpp"

#include <cmath>

#include <fmt/format.h>

namespace vantage::experiments {
namespace {

std::string duration_text(double duration_s) {
  const auto seconds = static_cast<long>(std::lround(duration_s));
  if (seconds < 60) {
    return fmt::format("{} s", seconds);
  }
  if (seconds < 3600) {
    return fmt::format("{} min {} s", seconds / 60, seconds % 60);
  }
  return fmt::format("{} h {} min", seconds / 3600, seconds % 3600 / 60);
}

}  // namespace

std::string progress_text(const SweepProgress& progress) {
  const double share = progress.units == 0 ? 1.0
                                           : static_cast<double>(progress.done) /
                                                 static_cast<double>(progress.units);
  std::string text = fmt::format("{:.0f} % {} of {} units, ", std::floor(100.0 * share),
                                 progress.done, progress.units);
  if (progress.is_stopping) {
    return text + "stopping after the running units; press Ctrl-C again to discard them";
  }
  const std::size_t run = progress.done - progress.done_before;
  if (run == 0) {
    return text + (progress.done == progress.units ? "0 s left" : "… left");
  }
  const double each_s = progress.elapsed_s / static_cast<double>(run);
  return text + duration_text(each_s * static_cast<double>(progress.units - progress.done)) +
         " left";
}

}  // namespace vantage::experiments
