#include "drivers/quadrotor/parameter_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace vantage::drivers {
namespace {

constexpr std::size_t kReasonsMax = 3;

}  // namespace

ParameterCheck::ParameterCheck(models::AutopilotDialect dialect,
                               const std::vector<wire::ParameterRule>& rules)
    : encoding_(wire::parameter_encoding(dialect)), entries_(rules.size()) {
  for (std::size_t i = 0; i < rules.size(); ++i) {
    entries_[i].known.rule = rules[i];
  }
}

void ParameterCheck::restart() {
  for (Item& item : entries_) {
    Item fresh;
    fresh.known.rule = std::move(item.known.rule);
    item = std::move(fresh);
  }
}

void ParameterCheck::take(const wire::mavlink::ParamValue& value, Time now) {
  const std::string name = wire::mavlink::parameter_name(value.param_id);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Item& item) { return item.known.rule.name == name; });
  const double actual =
      wire::mavlink::decode_parameter(value.param_value, value.param_type, encoding_);
  if (found == entries_.end() || !std::isfinite(actual)) {
    return;
  }
  found->known.actual = actual;
  found->type = value.param_type;
  found->is_to_be_set = found->is_to_be_set && !found->known.is_kept();
  if (!found->is_to_be_set) {
    found->known.is_settled = true;
    found->answered = now;
    found->requests = 0;
    found->next_request.reset();
  }
}

void ParameterCheck::repair() {
  for (Item& item : entries_) {
    if (item.known.actual && !item.known.is_kept()) {
      item.is_to_be_set = true;
      item.known.is_settled = false;
      item.requests = 0;
      item.next_request.reset();
    }
  }
}

ParameterCheck::Due ParameterCheck::due(Time now) {
  Due out;
  auto under_way = std::count_if(entries_.begin(), entries_.end(),
                                 [](const Item& item) { return item.next_request.has_value(); });
  for (Item& item : entries_) {
    const bool is_old = item.known.is_settled && now - item.answered > kRefresh;
    if (item.known.is_settled && !is_old && !item.next_request) {
      continue;
    }
    if (item.next_request ? now < *item.next_request : under_way >= kUnderWayMax) {
      continue;
    }
    if (item.requests == kRequestsMax) {
      item.known.is_settled = true;
      if (!item.is_to_be_set) {
        item.known.actual.reset();
      }
      item.is_to_be_set = false;
      item.answered = now;
      item.requests = 0;
      item.next_request.reset();
      --under_way;
      continue;
    }
    under_way += item.next_request ? 0 : 1;
    item.next_request = now + kAnswerWait;
    ++item.requests;
    const wire::ParameterRule& rule = item.known.rule;
    if (item.is_to_be_set) {
      wire::mavlink::ParamSet& set = out.sets.emplace_back();
      set.param_value = wire::mavlink::encode_parameter(rule.value, item.type, encoding_);
      set.param_type = item.type;
      set.param_id = wire::mavlink::parameter_id(rule.name);
    } else {
      wire::mavlink::ParamRequestRead& read = out.reads.emplace_back();
      read.param_index = -1;  // −1: the parameter is requested by name
      read.param_id = wire::mavlink::parameter_id(rule.name);
    }
  }
  return out;
}

std::size_t ParameterCheck::settled() const {
  return static_cast<std::size_t>(std::count_if(
      entries_.begin(), entries_.end(), [](const Item& item) { return item.known.is_settled; }));
}

bool ParameterCheck::is_kept() const {
  return std::all_of(entries_.begin(), entries_.end(), [](const Item& item) {
    return item.known.rule.is_advised || item.known.is_kept();
  });
}

std::optional<double> ParameterCheck::value(const std::string& name) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Item& item) { return item.known.rule.name == name; });
  return found == entries_.end() ? std::nullopt : found->known.actual;
}

std::vector<ParameterCheck::Entry> ParameterCheck::entries() const {
  std::vector<Entry> out;
  out.reserve(entries_.size());
  for (const Item& item : entries_) {
    out.push_back(item.known);
  }
  return out;
}

std::vector<std::string> ParameterCheck::reasons() const {
  std::vector<std::string> out;
  std::size_t broken = 0;
  bool is_reading = false;
  for (const Item& item : entries_) {
    if (item.known.rule.is_advised || item.known.is_kept()) {
      continue;
    }
    if (!item.known.actual && !item.known.is_settled) {
      is_reading = true;
    } else if (++broken <= kReasonsMax) {
      out.push_back(item.known.rule.violation_text(item.known.actual));
    }
  }
  if (broken > kReasonsMax) {
    out.push_back(
        fmt::format("{} more parameters differ; `vantage check SCENARIO --vehicles` "
                    "lists them",
                    broken - kReasonsMax));
  }
  if (is_reading) {
    out.push_back(
        fmt::format("reading the autopilot's parameters: {} of {}", settled(), entries_.size()));
  }
  return out;
}

}  // namespace vantage::drivers
