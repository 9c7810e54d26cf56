#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/autopilot/dialect.hpp"
#include "wire/mavlink/parameter.hpp"

namespace vantage::wire {

/// One parameter that an autopilot must have, and what comes of another value.
struct ParameterRule {
  enum class Kind { kExactly, kAtMost, kAtLeast, kBetween, kOneOf };

  std::string name;    ///< as the autopilot calls it, at most 16 characters
  double value = 0.0;  ///< that is loaded; it keeps the rule
  Kind kind = Kind::kExactly;
  std::vector<double> bounds;  ///< of the kind: none, one, two, or all that are allowed
  bool is_advised = false;     ///< a difference is told, and is no obstacle
  std::string otherwise;       ///< what the vehicle does then: "it flies on …"

  /// Autopilots keep single precision: a millionth of the number does not matter.
  [[nodiscard]] bool accepts(double actual) const;
  /// "5", "at most 0.5", "0, 8 or 16".
  [[nodiscard]] std::string wanted() const;
  /// "GUID_TIMEOUT is 3, wanted is at most 0.5: it flies on …"; without a value "… is not there".
  [[nodiscard]] std::string complaint(std::optional<double> actual) const;
};

/// Lines `NAME VALUE  # RULE: OTHERWISE`; lines that are empty or begin with # say nothing. RULE is
/// one of exactly, at most X, at least X, between X and Y, one of X Y …; `advised, ` may stand
/// before it.
/// @throws StartupError with the number of the line that is not so, that comes a second time, or
/// whose value breaks its own rule.
std::vector<ParameterRule> parse_parameter_rules(std::string_view text);

/// The text of config/autopilot/{ardupilot.parm,px4.params} when this was built.
const char* parameter_file(models::AutopilotDialect dialect);
/// The same, read.
const std::vector<ParameterRule>& parameter_rules(models::AutopilotDialect dialect);

/// How the autopilot writes whole numbers into the float of PARAM_VALUE.
constexpr mavlink::ParameterEncoding parameter_encoding(models::AutopilotDialect dialect) {
  return dialect == models::AutopilotDialect::kPx4 ? mavlink::ParameterEncoding::kBytewise
                                                   : mavlink::ParameterEncoding::kCast;
}

/// "3", "0.3": as few digits as say it in single precision.
std::string parameter_text(double value);

}  // namespace vantage::wire
