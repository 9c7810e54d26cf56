#include "wire/autopilot/parameter_rules.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::wire {
namespace {

constexpr double kPrecision = 1e-6;  // relative tolerance; single precision has seven digits

using Kind = ParameterRule::Kind;

bool is_about(double a, double b) {
  return std::abs(a - b) <= kPrecision * std::max({1.0, std::abs(a), std::abs(b)});
}

/// Returns true if the text starts with `words`, and then removes them from the text.
bool take(std::string_view& text, std::string_view words) {
  const bool is_there = text.starts_with(words);
  text.remove_prefix(is_there ? words.size() : 0);
  return is_there;
}

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos
             ? std::string_view()
             : text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

/// Parses numbers separated by blanks.
/// @throws StartupError for other text.
std::vector<double> numbers(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<double> out;
  for (double number = 0.0; in >> number;) {
    out.push_back(number);
  }
  if (!in.eof()) {
    throw StartupError(fmt::format("'{}' is not a number", text));
  }
  return out;
}

void read_rule(std::string_view text, ParameterRule& out) {
  out.is_advised = take(text, "advised, ");
  std::size_t count = 0;
  if (take(text, "at most ")) {
    out.kind = Kind::kAtMost;
    count = 1;
  } else if (take(text, "at least ")) {
    out.kind = Kind::kAtLeast;
    count = 1;
  } else if (take(text, "between ")) {
    out.kind = Kind::kBetween;
    count = 2;
  } else if (take(text, "one of ")) {
    out.kind = Kind::kOneOf;
  } else if (!take(text, "exactly")) {
    throw StartupError(fmt::format("'{}' is not a rule", text));
  }
  const std::size_t gap = out.kind == Kind::kBetween ? text.find(" and ") : std::string_view::npos;
  out.bounds = numbers(text.substr(0, gap));
  if (gap != std::string_view::npos) {
    for (const double bound : numbers(text.substr(gap + 5))) {
      out.bounds.push_back(bound);
    }
  }
  if (out.kind == Kind::kOneOf ? out.bounds.empty() : out.bounds.size() != count) {
    throw StartupError(fmt::format("'{}' is not a rule", text));
  }
}

ParameterRule read_line(std::string_view line) {
  constexpr std::size_t kNameMax = 16;
  const std::size_t comment = line.find('#');
  const std::size_t colon = line.find(':', comment == std::string_view::npos ? 0 : comment);
  if (comment == std::string_view::npos || colon == std::string_view::npos) {
    throw StartupError("must be `NAME VALUE  # RULE: what happens otherwise`");
  }
  ParameterRule out;
  const std::string_view head = trim(line.substr(0, comment));
  const std::size_t blank = head.find_first_of(" \t");
  out.name = head.substr(0, blank);
  const std::vector<double> values =
      numbers(blank == std::string_view::npos ? std::string_view() : head.substr(blank));
  if (out.name.empty() || out.name.size() > kNameMax || values.size() != 1) {
    throw StartupError("must begin with a name of at most 16 characters and one number");
  }
  out.value = values.front();
  read_rule(trim(line.substr(comment + 1, colon - comment - 1)), out);
  out.effect = trim(line.substr(colon + 1));
  if (!out.accepts(out.value)) {
    throw StartupError(out.name + " violates its own rule");
  }
  return out;
}

}  // namespace

bool ParameterRule::accepts(double actual) const {
  switch (kind) {
    case Kind::kExactly:
      return is_about(actual, value);
    case Kind::kAtMost:
      return actual <= bounds[0] || is_about(actual, bounds[0]);
    case Kind::kAtLeast:
      return actual >= bounds[0] || is_about(actual, bounds[0]);
    case Kind::kBetween:
      return (actual >= bounds[0] && actual <= bounds[1]) || is_about(actual, bounds[0]) ||
             is_about(actual, bounds[1]);
    case Kind::kOneOf:
      return std::any_of(bounds.begin(), bounds.end(),
                         [actual](double allowed) { return is_about(actual, allowed); });
  }
  return false;
}

std::string ParameterRule::requirement_text() const {
  switch (kind) {
    case Kind::kExactly:
      return parameter_text(value);
    case Kind::kAtMost:
      return "at most " + parameter_text(bounds[0]);
    case Kind::kAtLeast:
      return "at least " + parameter_text(bounds[0]);
    case Kind::kBetween:
      return "between " + parameter_text(bounds[0]) + " and " + parameter_text(bounds[1]);
    case Kind::kOneOf: {
      std::string out;
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        out += (i == 0 ? "" : i + 1 == bounds.size() ? " or " : ", ") + parameter_text(bounds[i]);
      }
      return out;
    }
  }
  return "";
}

std::string ParameterRule::violation_text(std::optional<double> actual) const {
  return actual ? fmt::format("{} is {}, must be {}: {}", name, parameter_text(*actual),
                              requirement_text(), effect)
                : fmt::format("{} is missing, must be {}: {}", name, requirement_text(), effect);
}

std::vector<ParameterRule> parse_parameter_rules(std::string_view text) {
  std::vector<ParameterRule> out;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.front() == '#') {
      continue;
    }
    try {
      ParameterRule rule = read_line(line);
      if (std::any_of(out.begin(), out.end(),
                      [&](const ParameterRule& other) { return other.name == rule.name; })) {
        throw StartupError(rule.name + " is listed twice");
      }
      out.push_back(std::move(rule));
    } catch (const StartupError& error) {
      throw StartupError(fmt::format("line {}: {}", number, error.what()));
    }
  }
  return out;
}

const std::vector<ParameterRule>& parameter_rules(models::AutopilotDialect dialect) {
  static const std::vector<ParameterRule> kPx4 =
      parse_parameter_rules(parameter_file(models::AutopilotDialect::kPx4));
  static const std::vector<ParameterRule> kArdupilot =
      parse_parameter_rules(parameter_file(models::AutopilotDialect::kArdupilot));
  return dialect == models::AutopilotDialect::kPx4 ? kPx4 : kArdupilot;
}

std::string parameter_text(double value) { return fmt::format("{:.7g}", value); }

}  // namespace vantage::wire
