#pragma once

#include <utility>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Those that are not 0, in the same order: what a process tells of itself.
inline std::vector<NamedCount> nonzero(std::vector<NamedCount> counts) {
  std::erase_if(counts, [](const NamedCount& each) { return each.count == 0; });
  return counts;
}

/// Appends those that are not 0.
inline void append_nonzero(std::vector<NamedCount>& all, std::vector<NamedCount> counts) {
  for (NamedCount& each : nonzero(std::move(counts))) {
    all.push_back(std::move(each));
  }
}

}  // namespace vantage::models
