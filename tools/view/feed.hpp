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
#include "logs/types/type_library.hpp"

namespace vantage::tools {

/// Topic of a channel's messages as they are on the bus.
inline constexpr std::string_view kRawTopics = "/lcm/";
/// A message as viewers are told it: with the names of its .lcm file where `types` has one, else by
/// its size and fingerprint.
logs::foxglove::Json raw_message(std::span<const std::uint8_t> data,
                                 const logs::TypeLibrary& types);

/// Hears everything on a bus and tells it to a Sink as viewers know it; and, where it is wanted,
/// each message as it is, on topic /lcm/CHANNEL. Publishes nothing.
class Feed {
 public:
  /// @param types  what else may be read than the house's messages; must live as long
  Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink,
       const logs::TypeLibrary& types);

  /// Waits up to `timeout`, then passes on what has arrived; how many, or bus::kSourceEnded.
  int handle(std::chrono::microseconds timeout) { return bus_.handle(timeout); }
  [[nodiscard]] const bus::Bus& bus() const { return bus_; }

 private:
  template <class Message>
  void listen(const bus::Channel<Message>& channel);
  /// A message as it is.
  void pass_on(std::string_view channel, std::span<const std::uint8_t> data);

  const bus::Clock& clock_;
  logs::foxglove::Sink& sink_;
  const logs::TypeLibrary& types_;
  std::set<std::string, std::less<>> raw_channels_;  ///< bounded
  logs::foxglove::Stream stream_;
  bus::Bus bus_;
};

}  // namespace vantage::tools
