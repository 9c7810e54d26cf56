#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/time.hpp"

namespace vantage::tools {

/// Right of one operator page to command the vehicles. The page is identified by a token. It must
/// report its presence: after kPresence without a report the claim ends, and with it the heartbeat.
class OperatorClaim {
 public:
  /// Reports come four times per second. 1 s after the heartbeat has ended, the vehicles hold.
  static constexpr Duration kPresence = std::chrono::milliseconds(1'200);

  /// Gives the claim to `token`. Returns false if another page holds it.
  bool claim(std::string token, Time now);
  /// Notes the presence of a page. Returns false if the page does not hold the claim.
  bool touch(std::string_view token, Time now);
  /// Ends the claim of a page that leaves.
  void release(std::string_view token);
  [[nodiscard]] bool is_held(Time now) const;
  [[nodiscard]] bool is_holder(std::string_view token, Time now) const;

 private:
  std::string token_;
  std::optional<Time> seen_;
};

/// Compares two secrets in a time that does not depend on where they differ.
bool is_same_secret(std::string_view a, std::string_view b);

}  // namespace vantage::tools
