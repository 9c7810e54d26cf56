#pragma once

#include <array>

namespace vantage::experiments {

/// A row of Table 4.1 with the printed values for coordinate descent (CD) and for RAIN.
struct TrackingTableRow {
  int robots;
  int targets;
  int attacks;
  std::array<double, 2> mean_m;  ///< CD, RAIN
  std::array<double, 2> peak_m;

  /// True if the row is drawn in the figures: ten robots and ten targets.
  [[nodiscard]] bool is_drawn() const { return robots == 10 && targets == 10; }
};

inline constexpr std::array<TrackingTableRow, 9> kTrackingTable = {
    {{5, 10, 1, {0.28, 0.19}, {9.62, 2.09}},
     {5, 10, 2, {1.47, 0.68}, {26.07, 15.71}},
     {5, 10, 4, {10.67, 4.9}, {225.47, 103.82}},
     {10, 5, 2, {0.35, 0.14}, {57.65, 1.87}},
     {10, 5, 4, {0.39, 0.28}, {6.66, 3.17}},
     {10, 5, 6, {2.07, 0.65}, {93.27, 15.63}},
     {10, 10, 2, {0.13, 0.08}, {1.4, 1.32}},
     {10, 10, 4, {0.24, 0.23}, {4.19, 2.66}},
     {10, 10, 6, {4.39, 1.2}, {69.77, 26.4}}}};

/// Table cells of the methods.
inline constexpr std::array<const char*, 2> kTrackingMethods = {"cd", "rain"};

}  // namespace vantage::experiments
