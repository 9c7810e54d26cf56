#include "bus/node/air_budget.hpp"

#include <algorithm>
#include <utility>

#include "bus/transport/url.hpp"

namespace vantage::bus {
namespace {

constexpr double kBurstS = 2.0;
constexpr double kBytesPerKbit = 125.0;
constexpr Duration kStatusPeriodMax{500'000};
constexpr Duration kHealthPeriodMax{30'000'000};

/// Classes by the beginning of the channel name. Channels that are not listed are unlimited.
constexpr std::array<std::pair<std::string_view, AirClass>, 16> kClasses{{
    {"PLAN_", AirClass::kMotion},
    {"PROPOSAL_", AirClass::kMotion},
    {"TEAM_PROPOSAL_", AirClass::kMotion},
    {"EXTERNAL_PLAN_", AirClass::kMotion},
    {"POSE_", AirClass::kMotion},
    {"MEASUREMENT_", AirClass::kObservation},
    {"VEHICLE_", AirClass::kStatus},
    {"COMPACT_BELIEF_", AirClass::kKnowledge},
    {"MAP_", AirClass::kKnowledge},
    {"HEALTH_", AirClass::kHealth},
    {"BELIEF_", AirClass::kHost},
    {"MIXTURE_", AirClass::kHost},
    {"SCAN_", AirClass::kHost},
    {"ODOMETRY_", AirClass::kHost},
    {"SIGHTINGS_", AirClass::kHost},
    {"EXTERNAL_REQUEST_", AirClass::kHost},
}};

/// Returns the number of copies of each message on the network: one per peer on another host.
double copies_of(const std::string& url) {
  const Url parsed = parse_url(url);
  const auto peers = parsed.options.find("peers");
  const auto commas = peers == parsed.options.end()
                          ? 0
                          : std::count(peers->second.begin(), peers->second.end(), ',');
  return static_cast<double>(std::max<std::ptrdiff_t>(1, commas));
}

}  // namespace

double share_of(AirClass kind) {
  switch (kind) {
    case AirClass::kMotion:
      return 0.40;
    case AirClass::kObservation:
      return 0.12;
    case AirClass::kStatus:
      return 0.10;
    case AirClass::kKnowledge:
      return 0.32;
    case AirClass::kHealth:
      return 0.015;  // for each process: sensor, estimator, planner, driver
    case AirClass::kHost:
    case AirClass::kUnlimited:
      return 0.0;
  }
  return 0.0;
}

bool may_be_repeated(std::string_view channel) {
  return std::any_of(kClasses.begin(), kClasses.end(), [&](const auto& each) {
    return each.second == AirClass::kMotion && channel.starts_with(each.first);
  });
}

std::size_t bytes_on_air(std::size_t channel_bytes, std::size_t payload_bytes) {
  constexpr std::size_t kIpBytes = 20;
  constexpr std::size_t kUdpBytes = 8;
  constexpr std::size_t kLcmBytes = 8;
  constexpr std::size_t kFrameBytes = 1480;  // bytes of a frame after the IP header
  const std::size_t datagram = kUdpBytes + kLcmBytes + channel_bytes + 1 + payload_bytes;
  return datagram + kIpBytes * ((datagram + kFrameBytes - 1) / kFrameBytes);
}

AirBudget::AirBudget(const scenario::Scenario& scenario)
    : rate_Bps_(scenario.network.budget_kbitps * kBytesPerKbit / copies_of(scenario.network.url)) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    robots_.insert(robot.name);
  }
}

std::string_view AirBudget::robot_of(std::string_view channel) const {
  const std::string_view name = channel.substr(channel.rfind('_') + 1);
  return robots_.contains(name) ? name : std::string_view();
}

AirClass AirBudget::class_of(std::string_view channel) const {
  const auto found = std::find_if(kClasses.begin(), kClasses.end(), [&](const auto& each) {
    return channel.starts_with(each.first);
  });
  return found == kClasses.end() || robot_of(channel).empty() ? AirClass::kUnlimited
                                                              : found->second;
}

bool AirBudget::is_thinned(std::string_view channel) const {
  const AirClass kind = class_of(channel);
  return kind != AirClass::kUnlimited && kind != AirClass::kMotion;
}

std::string AirBudget::key_of(std::string_view channel, AirClass kind) const {
  return kind == AirClass::kHealth
             ? std::string(channel)
             : std::to_string(static_cast<int>(kind)) + std::string(robot_of(channel));
}

double AirBudget::filled_bytes(const Bucket& bucket, double rate_Bps, Time now) const {
  const double capacity = rate_Bps * kBurstS;
  if (bucket.filled == Time{}) {
    return capacity;
  }
  const double since_s = std::max(0.0, to_seconds(now - bucket.filled));
  return std::min(capacity, bucket.bytes + rate_Bps * since_s);
}

Reach AirBudget::admit(std::string_view channel, std::size_t payload_bytes, Time now) {
  const AirClass kind = class_of(channel);
  if (kind == AirClass::kUnlimited) {
    return Reach::kAll;
  }
  if (kind == AirClass::kHost) {
    return Reach::kHost;
  }
  Bucket& bucket = buckets_[key_of(channel, kind)];
  bucket.bytes = filled_bytes(bucket, rate_Bps_ * share_of(kind), now);
  bucket.filled = std::max(bucket.filled, now);
  const bool is_empty = bucket.bytes <= 0.0;
  const bool is_overdue = (kind == AirClass::kStatus && now - bucket.sent >= kStatusPeriodMax) ||
                          (kind == AirClass::kHealth && now - bucket.sent >= kHealthPeriodMax);
  const bool is_sent_anyway = kind == AirClass::kMotion || is_overdue;
  if (is_empty && !is_sent_anyway) {
    ++held_;
    return Reach::kHost;
  }
  overdrawn_ += is_empty ? 1 : 0;
  bucket.bytes -= static_cast<double>(bytes_on_air(channel.size(), payload_bytes));
  if (is_sent_anyway) {  // the debt is bounded, so that a burst does not silence a class for long
    bucket.bytes = std::max(bucket.bytes, -rate_Bps_ * kBurstS);
  }
  bucket.sent = now;
  return Reach::kAll;
}

std::size_t AirBudget::payload_left(std::string_view channel, Time now) const {
  const AirClass kind = class_of(channel);
  const auto bucket = buckets_.find(key_of(channel, kind));
  const double bytes = filled_bytes(bucket == buckets_.end() ? Bucket{} : bucket->second,
                                    rate_Bps_ * share_of(kind), now);
  const auto head = static_cast<double>(bytes_on_air(channel.size(), 0));
  return static_cast<std::size_t>(std::max(0.0, bytes - head));
}

std::vector<models::NamedCount> AirBudget::counters() const {
  return {{"air.held", held_}, {"air.overdrawn", overdrawn_}};
}

}  // namespace vantage::bus
