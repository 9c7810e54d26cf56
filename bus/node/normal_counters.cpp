#include "bus/node/normal_counters.hpp"

#include <algorithm>
#include <array>

namespace vantage::bus {

bool is_rejection(std::string_view counter) {
  constexpr std::array<std::string_view, 4> kRejections = {"gated", "undiscoverable",
                                                           "jammed_looks", "map.jammed_scans"};
  return std::find(kRejections.begin(), kRejections.end(), counter) != kRejections.end();
}

bool is_normal_counter(std::string_view counter) {
  return counter == "transport.messages_sent" || counter == "transport.messages_received" ||
         counter.ends_with(".fresh") || counter.ends_with(".skipped") ||
         counter.ends_with(".repeated") || counter == "air.held" || counter.ends_with("_us") ||
         counter.ends_with("_rounds") || is_rejection(counter);
}

}  // namespace vantage::bus
