#pragma once

#include <string_view>

namespace vantage::bus {

/// True if a subscription to `pattern` receives `channel`: the same name, or a pattern "PREFIX*".
inline bool channel_matches(std::string_view pattern, std::string_view channel) {
  if (!pattern.empty() && pattern.back() == '*') {
    return channel.starts_with(pattern.substr(0, pattern.size() - 1));
  }
  return pattern == channel;
}

}  // namespace vantage::bus
