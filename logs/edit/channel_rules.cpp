#include "logs/edit/channel_rules.hpp"

#include <algorithm>

#include "core/check.hpp"
#include "logs/file/log_event.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kKnownMax = 10'000;

std::vector<std::regex> compiled(const std::vector<std::string>& texts) {
  std::vector<std::regex> out;
  for (const std::string& text : texts) {
    try {
      out.emplace_back(text, std::regex::ECMAScript | std::regex::optimize);
    } catch (const std::regex_error& error) {
      throw UsageError("channel expression '" + text +
                       "' is not a valid regular expression: " + error.what());
    }
  }
  return out;
}

bool any_matches(const std::vector<std::regex>& expressions, const std::string& name) {
  return std::any_of(expressions.begin(), expressions.end(),
                     [&](const std::regex& each) { return std::regex_match(name, each); });
}

}  // namespace

ChannelFilter::ChannelFilter(const std::vector<std::string>& include,
                             const std::vector<std::string>& exclude)
    : include_(compiled(include)), exclude_(compiled(exclude)) {}

bool ChannelFilter::takes(std::string_view channel) {
  if (include_.empty() && exclude_.empty()) {
    return true;
  }
  const auto known = known_.find(channel);
  if (known != known_.end()) {
    return known->second;
  }
  const std::string name(channel);
  const bool taken =
      (include_.empty() || any_matches(include_, name)) && !any_matches(exclude_, name);
  if (known_.size() >= kKnownMax) {
    known_.clear();  // limits the memory: foreign logs may contain any number of names
  }
  known_.emplace(name, taken);
  return taken;
}

ChannelRenames::ChannelRenames(const std::vector<std::string>& rules) {
  for (const std::string& text : rules) {
    const std::size_t equals = text.find('=');
    require(equals != std::string::npos && equals > 0 && equals + 1 < text.size(),
            "rename rule '" + text + "': must be OLD=NEW or OLD*=NEW*");
    Rule rule{text.substr(0, equals), text.substr(equals + 1)};
    rule.is_prefix = rule.from.ends_with('*');
    require(rule.is_prefix == rule.to.ends_with('*'),
            "rename rule '" + text + "': both names must end in '*', or neither");
    if (rule.is_prefix) {
      rule.from.pop_back();
      rule.to.pop_back();
    }
    rules_.push_back(std::move(rule));
  }
}

std::optional<std::string> ChannelRenames::rename(std::string_view channel) const {
  const auto rule = std::find_if(rules_.begin(), rules_.end(), [&](const Rule& each) {
    return each.is_prefix ? channel.starts_with(each.from) : channel == each.from;
  });
  std::string name(channel);
  if (rule != rules_.end()) {
    name = rule->is_prefix ? rule->to + name.substr(rule->from.size()) : rule->to;
  }
  if (name.empty() || name.size() > kChannelBytesMax) {
    return std::nullopt;
  }
  return name;
}

}  // namespace vantage::logs
