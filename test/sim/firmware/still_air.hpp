#pragma once

#include "sim/firmware/multirotor.hpp"

namespace vantage::test {

inline constexpr double kGravityMps2 = 9.81;

inline sim::MultirotorParameters still_air() {
  sim::MultirotorParameters out;
  out.gust_sigma_mps = 0.0;
  return out;
}

}  // namespace vantage::test
