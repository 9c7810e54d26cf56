#pragma once

#include <vector>

#include "models/belief/gaussian.hpp"

namespace vantage::models {

/// One weighted Gaussian of a mixture.
struct Component {
  double weight = 0.0;
  Gaussian belief;
};
using Mixture = std::vector<Component>;

}  // namespace vantage::models
