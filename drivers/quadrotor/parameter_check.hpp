#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "wire/autopilot/parameter_rules.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// Check of all parameters of an autopilot that have a rule. It reads and compares them, and
/// corrects them on request. It does no input or output.
///
/// Only a few requests are pending simultaneously, so that a radio link is not flooded. Each
/// request is repeated a few times and then given up, since autopilots do not answer requests for
/// unknown names.
class ParameterCheck {
 public:
  static constexpr Duration kAnswerWait = std::chrono::milliseconds(500);
  static constexpr Duration kRefresh = std::chrono::seconds(30);
  static constexpr int kRequestsMax = 6;
  static constexpr int kUnderWayMax = 4;

  ParameterCheck(models::AutopilotDialect dialect, const std::vector<wire::ParameterRule>& rules);

  /// Rule with the known value of its parameter.
  struct Entry {
    wire::ParameterRule rule;
    std::optional<double> actual;  ///< nullopt: no answer yet, or no such parameter
    bool is_settled = false;       ///< the request was answered or given up
    [[nodiscard]] bool is_kept() const { return actual && rule.accepts(*actual); }
  };

  /// Deletes all values, because another or a restarted vehicle may answer from now on.
  void restart();
  /// Processes a value from the autopilot, requested or not.
  void take(const wire::mavlink::ParamValue& value, Time now);
  /// Sets each existing parameter that violates its rule, and reads it back.
  void repair();

  struct Due {
    std::vector<wire::mavlink::ParamRequestRead> reads;
    std::vector<wire::mavlink::ParamSet> sets;
  };
  /// Returns the messages to send now; the caller sets their target system. Old values are
  /// requested again.
  Due due(Time now);

  /// True if each request was answered or given up.
  [[nodiscard]] bool is_complete() const { return settled() == entries_.size(); }
  [[nodiscard]] std::size_t settled() const;
  /// True if all rules that matter for safety are known to be met.
  [[nodiscard]] bool is_kept() const;
  /// Returns the value of a parameter; nullopt if the parameter has no rule or its value is
  /// unknown.
  [[nodiscard]] std::optional<double> value(const std::string& name) const;
  /// Returns the entries in the order of the rules.
  [[nodiscard]] std::vector<Entry> entries() const;
  /// Returns texts that state why the vehicle must not be armed: a few rule violations, and the
  /// progress of reading.
  [[nodiscard]] std::vector<std::string> reasons() const;

 private:
  struct Item {
    Entry known;
    std::uint8_t type = wire::mavlink::parameter_type::kFloat;
    int requests = 0;  ///< number of requests since the entry was last settled
    std::optional<Time> next_request;
    Time answered{};
    bool is_to_be_set = false;
  };
  wire::mavlink::ParameterEncoding encoding_;
  std::vector<Item> entries_;
};

}  // namespace vantage::drivers
