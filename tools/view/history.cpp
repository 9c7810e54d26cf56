#include "tools/view/history.hpp"

#include <cmath>
#include <optional>
#include <utility>

namespace vantage::tools {
namespace {

using logs::foxglove::Json;
using logs::foxglove::Schema;

constexpr const char* kBodies = "/transforms";
constexpr const char* kPaths = "/paths";
constexpr Duration kStatePeriod = std::chrono::seconds(1);
constexpr Duration kPathPeriod = std::chrono::milliseconds(200);

// Returns the minimum time between two stored records of a topic. Zero: all records are stored;
// nullopt: no records are stored.
std::optional<Duration> period_of(const std::string& topic, Schema schema) {
  switch (schema) {
    case Schema::kTeam:
    case Schema::kPlan:
    case Schema::kLog:
    case Schema::kScenario:
      return Duration{0};
    case Schema::kVehicle:
    case Schema::kTargets:
    case Schema::kHealth:
      return kStatePeriod;
    case Schema::kFrameTransforms:
      return topic == kBodies ? std::optional(kPathPeriod) : std::nullopt;
    default:
      return std::nullopt;
  }
}

Json positions_of(const Json& transforms) {
  const auto to_cm = [](const Json& coordinate) {
    return 0.01 * std::round(100.0 * coordinate.get<double>());
  };
  Json positions = Json::object();
  for (const Json& each : transforms.at("transforms")) {
    const Json& at = each.at("translation");
    positions[each.at("child_frame_id").get<std::string>()] = {to_cm(at.at("x")), to_cm(at.at("y")),
                                                               to_cm(at.at("z"))};
  }
  return positions;
}

}  // namespace

bool History::wants(const std::string& topic, Schema schema, bool is_state) {
  const bool is_wanted_there = audience_.wants(topic, schema, is_state);
  audience_wants_ = is_wanted_there && forwarding_ == Forwarding::kRecords;
  const auto period = period_of(topic, schema);
  const auto last = written_.find(topic);
  is_due_ = period && (last == written_.end() || clock_.now() - last->second >= *period ||
                       clock_.now() < last->second);  // the time decreased: a new run has begun
  return is_due_ || audience_wants_;
}

void History::write(const std::string& topic, Time time, const Json& content) {
  if (is_due_) {
    written_[topic] = time;
    const bool is_bodies = topic == kBodies;
    keep(is_bodies ? kPaths : topic, time, is_bodies ? positions_of(content) : content);
  }
  if (audience_wants_) {
    audience_.write(topic, time, content);
  }
}

void History::keep(const std::string& topic, Time time, const Json& content) {
  std::string record = Json::array({topic, to_utime(time), content})
                           .dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::lock_guard lock(mutex_);
  bytes_ += record.size();
  records_.push_back(std::move(record));
  while (bytes_ > bytes_max_) {
    bytes_ -= records_.front().size();
    records_.pop_front();
  }
}

std::string History::text() const {
  const std::lock_guard lock(mutex_);
  std::string out = "[";
  out.reserve(bytes_ + records_.size() + 2);
  for (const std::string& record : records_) {
    out += out.size() > 1 ? "," : "";
    out += record;
  }
  return out + "]";
}

}  // namespace vantage::tools
