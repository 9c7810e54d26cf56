#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "logs/foxglove/stream.hpp"

namespace vantage::tools {

/// Topic of a channel's messages as they are on the bus.
inline constexpr std::string_view kRawTopics = "/lcm/";
/// A message as viewers are told it.
logs::foxglove::Json raw_message(std::span<const std::uint8_t> data);

/// Hears everything on a bus and tells it to a Sink as viewers know it; and, where it is wanted,
/// each message as it is, on topic /lcm/CHANNEL (a foreign type's is told by its size and
/// fingerprint). Publishes nothing.
class Feed {
 public:
  Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink);

  /// Waits up to `timeout`, then passes on what has arrived; how many, or bus::kSourceEnded.
  int handle(std::chrono::microseconds timeout) { return bus_.handle(timeout); }
  [[nodiscard]] const bus::Bus& bus() const { return bus_; }

 private:
  template <class Message>
  void listen(const bus::Channel<Message>& channel);

  const bus::Clock& clock_;
  logs::foxglove::Sink& sink_;
  std::set<std::string, std::less<>> raw_channels_;  ///< bounded
  logs::foxglove::Stream stream_;
  bus::Bus bus_;
};

}  // namespace vantage::tools
