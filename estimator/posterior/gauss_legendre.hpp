#pragma once

#include <array>
#include <cstddef>

namespace vantage::estimator {

/// Gauss-Legendre on [−1, 1]. Source: Abramowitz, Stegun (1964), table 25.4.
inline constexpr std::size_t kLegendrePoints = 12;  ///< two points per node: −x and x
inline constexpr std::array<double, kLegendrePoints / 2> kLegendreNode = {
    0.125233408511469, 0.367831498998180, 0.587317954286617,
    0.769902674194305, 0.904117256370475, 0.981560634246719};
inline constexpr std::array<double, kLegendrePoints / 2> kLegendreWeight = {
    0.249147045813403, 0.233492536538355, 0.203167426723066,
    0.160078328543346, 0.106939325995318, 0.047175336386512};
inline constexpr std::array<double, 2> kLegendreSide = {-1.0, 1.0};

}  // namespace vantage::estimator
