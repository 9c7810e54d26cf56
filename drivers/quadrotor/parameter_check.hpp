#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "wire/autopilot/parameter_rules.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// Asks an autopilot for every parameter that there is a rule for, judges what it answers, and
/// mends it when told to. Bytes and time are others' business.
///
/// A few questions are under way at a time, so that a radio is not flooded; each is repeated until
/// it is answered, and given up after a few times: autopilots do not answer to names they do not
/// know.
class ParameterCheck {
 public:
  static constexpr Duration kAnswerWait = std::chrono::milliseconds(500);
  static constexpr Duration kRefresh = std::chrono::seconds(30);
  static constexpr int kAsksMax = 6;
  static constexpr int kUnderWayMax = 4;

  ParameterCheck(models::AutopilotDialect dialect, const std::vector<wire::ParameterRule>& rules);

  /// One rule and what is known of it.
  struct Entry {
    wire::ParameterRule rule;
    std::optional<double> actual;  ///< nullopt: not answered yet, or not there
    bool is_settled = false;       ///< answered, or given up
    [[nodiscard]] bool is_kept() const { return actual && rule.accepts(*actual); }
  };

  /// Forgets every value: what answers now may be another vehicle, or a restarted one.
  void restart();
  /// Whatever the autopilot says of a parameter, asked for or not.
  void take(const wire::mavlink::ParamValue& value, Time now);
  /// Has every existing parameter that breaks its rule set to its value, and read back.
  void mend();

  struct Due {
    std::vector<wire::mavlink::ParamRequestRead> reads;
    std::vector<wire::mavlink::ParamSet> sets;
  };
  /// What is to be said now, without the target. Old values are asked for again.
  Due due(Time now);

  /// All are answered or given up.
  [[nodiscard]] bool is_complete() const { return settled() == entries_.size(); }
  [[nodiscard]] std::size_t settled() const;
  /// Every rule that matters for safety is known to be kept.
  [[nodiscard]] bool is_kept() const;
  /// Of this parameter; nullopt for one without a rule, or not known.
  [[nodiscard]] std::optional<double> value(const std::string& name) const;
  /// By the order of the rules.
  [[nodiscard]] std::vector<Entry> entries() const;
  /// Why the vehicle must not be armed, in words: a few differences, or how far the reading is.
  [[nodiscard]] std::vector<std::string> reasons() const;

 private:
  struct Item {
    Entry known;
    std::uint8_t type = wire::mavlink::parameter_type::kFloat;
    int asked = 0;  ///< since it was settled last
    std::optional<Time> next_ask;
    Time answered{};
    bool is_to_be_set = false;
  };
  wire::mavlink::ParameterEncoding encoding_;
  std::vector<Item> entries_;
};

}  // namespace vantage::drivers
