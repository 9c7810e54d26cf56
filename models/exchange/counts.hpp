#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/latency_record.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Returns the counts that are not 0, in the same order, for the report of a process.
inline std::vector<NamedCount> nonzero(std::vector<NamedCount> counts) {
  std::erase_if(counts, [](const NamedCount& each) { return each.count == 0; });
  return counts;
}

/// Appends the counts that are not 0.
inline void append_nonzero(std::vector<NamedCount>& all, std::vector<NamedCount> counts) {
  for (NamedCount& each : nonzero(std::move(counts))) {
    all.push_back(std::move(each));
  }
}

/// Appends NAME_p50_us, NAME_p99_us and NAME_max_us, unless nothing was measured.
inline void append_latency(std::vector<NamedCount>& all, const std::string& name,
                           const LatencyRecord& record) {
  if (record.count() > 0) {
    all.push_back({name + "_p50_us", record.percentile_us(0.5)});
    all.push_back({name + "_p99_us", record.percentile_us(0.99)});
    all.push_back({name + "_max_us", record.max_us()});
  }
}

}  // namespace vantage::models
