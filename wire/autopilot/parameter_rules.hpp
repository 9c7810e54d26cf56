#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/autopilot/dialect.hpp"
#include "wire/mavlink/parameter.hpp"

namespace vantage::wire {

/// Required value of one autopilot parameter, and the effect of a wrong value.
struct ParameterRule {
  enum class Kind { kExactly, kAtMost, kAtLeast, kBetween, kOneOf };

  std::string name;    ///< name of the parameter in the autopilot, at most 16 characters
  double value = 0.0;  ///< the value to load; it satisfies the rule
  Kind kind = Kind::kExactly;
  std::vector<double> bounds;  ///< depends on `kind`: none, one, two, or all allowed values
  bool is_advised = false;     ///< true: a difference is only reported; it does not prevent flight
  std::string effect;          ///< effect of a wrong value on the vehicle: "it flies on …"

  /// True if `actual` satisfies the rule. Autopilots store values in single precision, so a
  /// relative difference of 1e-6 is allowed.
  [[nodiscard]] bool accepts(double actual) const;
  /// Returns the rule as text: "5", "at most 0.5", "0, 8 or 16".
  [[nodiscard]] std::string requirement_text() const;
  /// Returns a text such as "GUID_TIMEOUT is 3, must be at most 0.5: it flies on …"; without a
  /// value "… is missing, …".
  [[nodiscard]] std::string violation_text(std::optional<double> actual) const;
};

/// Parses lines `NAME VALUE  # RULE: EFFECT`; lines that are empty or begin with # are skipped.
/// RULE is one of exactly, at most X, at least X, between X and Y, one of X Y …; it may be preceded
/// by `advised, `.
/// @throws StartupError with the number of a line that is malformed, repeats a name, or has a value
/// that violates its own rule.
std::vector<ParameterRule> parse_parameter_rules(std::string_view text);

/// Returns the text of config/autopilot/{ardupilot.parm,px4.params} at build time.
const char* parameter_file(models::AutopilotDialect dialect);
/// Returns the parsed rules of parameter_file().
const std::vector<ParameterRule>& parameter_rules(models::AutopilotDialect dialect);

/// Returns how the autopilot encodes integers in the float of PARAM_VALUE.
constexpr mavlink::ParameterEncoding parameter_encoding(models::AutopilotDialect dialect) {
  return dialect == models::AutopilotDialect::kPx4 ? mavlink::ParameterEncoding::kBytewise
                                                   : mavlink::ParameterEncoding::kCast;
}

/// Returns the number with the fewest digits that single precision requires: "3", "0.3".
std::string parameter_text(double value);

}  // namespace vantage::wire
