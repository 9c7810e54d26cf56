#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bus/transport/channel_index.hpp"
#include "bus/transport/transport.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::bus {

/// Kinds of traffic of one robot. Each kind has a separate share of the budget, in every process
/// that sends this kind.
enum class AirClass : std::uint8_t {
  kMotion,       ///< plans, proposals, poses; sent always and twice, even beyond the share
  kObservation,  ///< measurements
  kStatus,       ///< VEHICLE_R; at least every 0.5 s
  kKnowledge,    ///< compact beliefs, maps
  kHealth,       ///< HEALTH_*; at least every 30 s
  kHost,         ///< for processes of the robot's own host only
  kUnlimited,    ///< not sent by a robot
};

/// Returns the share of the budget that one process may use for one class; 0 for kHost and
/// kUnlimited. The shares of all processes of a robot add up to 1.
double share_of(AirClass kind);

/// True for channels of kMotion. With a budget, each of their messages is published twice, with the
/// same run id and sequence number.
bool may_be_repeated(std::string_view channel);

/// Returns the bytes that a message occupies on the network: headers of IP (one per fragment), UDP
/// and LCM, channel name, payload.
std::size_t bytes_on_air(std::size_t channel_bytes, std::size_t payload_bytes);

/// Limiter of the messages that the robots of a process send to other hosts
/// (network.budget_kbitps).
///
/// Each class of messages has a token bucket that holds at most two seconds of its share. A message
/// leaves the host if its bucket is not empty, and may empty it below zero. So each share is an
/// exact limit of the mean rate. With peers in network.url, the copies for all peers count.
/// Messages that do not leave the host are still received there. The result depends only on the
/// channels, sizes and times of the messages.
class AirBudget {
 public:
  explicit AirBudget(const scenario::Scenario& scenario);

  /// Decides whether a message of `payload_bytes` may be sent to other hosts. If so, takes its
  /// bytes from the bucket.
  Reach admit(std::string_view channel, std::size_t payload_bytes, Time now);
  /// Returns the largest payload that the bucket of `channel` has room for.
  [[nodiscard]] std::size_t payload_left(std::string_view channel, Time now) const;

  [[nodiscard]] AirClass class_of(std::string_view channel) const;
  /// Returns the robot that sends on `channel`; empty for channels of no robot.
  [[nodiscard]] std::string_view robot_of(std::string_view channel) const;
  /// True if receivers on other hosts do not receive every message.
  [[nodiscard]] bool is_thinned(std::string_view channel) const;

  /// Returns how often each message of the channel is sent: twice if vehicles move according to the
  /// messages, so that the loss of one frame loses no message. Otherwise once.
  [[nodiscard]] int copies_on(std::string_view channel) const {
    return class_of(channel) == AirClass::kMotion ? 2 : 1;
  }

  /// Returns the messages held on the host because of the budget, and those of kMotion that
  /// exceeded their share.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  struct Bucket {
    double bytes = 0.0;  ///< bytes left at the time `filled`
    Time filled{};       ///< time of the last change of `bytes`; epoch: the bucket is full
    Time sent{};         ///< time of the last message that left the host
  };
  [[nodiscard]] double filled_bytes(const Bucket& bucket, double rate_Bps, Time now) const;
  [[nodiscard]] std::string key_of(std::string_view channel, AirClass kind) const;

  double rate_Bps_;
  std::set<std::string, std::less<>> robots_;
  ByName<Bucket> buckets_;  ///< by class and robot; for HEALTH by channel
  std::int64_t held_ = 0;
  std::int64_t overdrawn_ = 0;
};

}  // namespace vantage::bus
