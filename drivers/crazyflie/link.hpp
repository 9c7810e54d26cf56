#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/crazyflie/set_up.hpp"
#include "drivers/crazyflie/table_fetch.hpp"
#include "drivers/crazyflie/telemetry.hpp"
#include "models/exchange/messages.hpp"
#include "wire/crtp/flight.hpp"
#include "wire/crtp/packet.hpp"

namespace vantage::drivers {

/// CRTP connection with one Crazyflie: search, tables, set-up, log data, and packets to send. Bytes
/// and time are passed in, packets to send are returned.
class CrazyflieLink {
 public:
  explicit CrazyflieLink(std::shared_ptr<TableCache> cache) : cache_(std::move(cache)) {}

  /// Processes the bytes of one packet from the vehicle. Returns false if they are not a packet.
  bool receive(std::span<const std::uint8_t> bytes, Time now);
  /// Sets the pose of the vehicle on the ground; nullopt if it is unknown or the vehicle moves. The
  /// firmware's filter does not converge from an attitude that is wrong by half a turn. Therefore
  /// the estimate starts at this pose, and is restarted while its yaw differs.
  void set_start(const std::optional<Pose3>& world_from_body) { start_ = world_from_body; }
  /// Sends all pending requests.
  void tick(Time now);
  /// Sends a packet; nullopt (a refused encoding) is only counted.
  void send(const std::optional<wire::crtp::Packet>& packet);
  std::vector<wire::crtp::Encoded> take_output();

  [[nodiscard]] const CrazyflieTelemetry& telemetry() const { return telemetry_; }
  [[nodiscard]] bool is_connected(Time now) const;
  /// True if the vehicle is set up and reports its state.
  [[nodiscard]] bool is_ready(Time now) const;
  [[nodiscard]] bool has_battery() const { return set_up_.has_battery(); }
  /// Returns a text that states why the vehicle cannot be used now; nullopt if it can.
  [[nodiscard]] std::optional<std::string> fault(Time now) const;
  /// Returns the newest reply of the high-level commander to `command` since `sent`.
  [[nodiscard]] std::optional<std::uint8_t> high_level_error(wire::crtp::HighLevelCommand command,
                                                             Time sent) const;
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  enum class Phase { kSearch, kParameterTable, kLogTable, kSetUp, kReady };
  void take(const wire::crtp::Packet& packet, Time now);
  void search(Time now);
  [[nodiscard]] bool is_estimate_turned(Time now) const;

  std::shared_ptr<TableCache> cache_;
  Phase phase_ = Phase::kSearch;
  TableFetch parameters_{wire::crtp::Port::kParameter};
  TableFetch logs_{wire::crtp::Port::kLog};
  CrazyflieSetUp set_up_;
  CrazyflieTelemetry telemetry_;
  std::optional<Pose3> start_;
  std::vector<wire::crtp::Packet> output_;
  std::optional<Time> received_at_;
  Time next_search_{};
  Time phase_since_{};
  std::optional<std::uint32_t> protocol_;
  std::optional<wire::crtp::HighLevelReply> high_level_;
  Time high_level_at_{};
  std::string console_;  ///< newest text of the vehicle's console
  std::int64_t packets_ = 0;
  std::int64_t undecoded_ = 0;
  std::int64_t encodings_refused_ = 0;
  std::int64_t connections_ = 0;
};

}  // namespace vantage::drivers
