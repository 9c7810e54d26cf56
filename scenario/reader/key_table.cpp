#include "scenario/reader/key_table.hpp"

#include <algorithm>
#include <utility>

namespace vantage::scenario {
namespace {

std::string without_indices(const std::string& path) {
  std::string out;
  bool is_index = false;
  for (const char c : path) {
    is_index = is_index && c != ']';
    if (!is_index) {
      out += c;
    }
    is_index = is_index || c == '[';
  }
  return out;
}

}  // namespace

void KeyTable::note(KeyRule rule) {
  rule.path = without_indices(rule.path);
  const auto known = std::find_if(rules_.begin(), rules_.end(),
                                  [&](const KeyRule& each) { return each.path == rule.path; });
  if (known == rules_.end()) {
    rules_.push_back(std::move(rule));
    return;
  }
  if (!rule.values.empty()) {
    known->values = std::move(rule.values);
  }
  if (known->initial.empty()) {
    known->initial = std::move(rule.initial);
  }
  known->is_required = known->is_required || rule.is_required;
  known->line = known->line > 0 ? known->line : rule.line;
}

}  // namespace vantage::scenario
