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

/// Prefix of the topics of unchanged bus messages: "/lcm/CHANNEL".
inline constexpr std::string_view kRawTopics = "/lcm/";
/// Converts a message into JSON with the field names of its .lcm file if `types` contains its type;
/// otherwise returns its size and fingerprint.
logs::foxglove::Json raw_message(std::span<const std::uint8_t> data,
                                 const logs::TypeLibrary& types);

/// Converts all messages of a bus into records of a Sink. If the Sink wants topic /lcm/CHANNEL,
/// also writes each unchanged message of CHANNEL to this topic. Publishes nothing.
class Feed {
 public:
  /// @param types  message types for raw messages; must outlive the feed
  Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink,
       const logs::TypeLibrary& types);

  /// Waits up to `timeout` and handles all messages that have arrived. Returns their number, or
  /// bus::kSourceEnded.
  int handle(std::chrono::microseconds timeout) { return bus_.handle(timeout); }

 private:
  template <class Message>
  void listen(const bus::Channel<Message>& channel);
  /// Writes an unchanged message.
  void pass_on(std::string_view channel, std::span<const std::uint8_t> data);

  const bus::Clock& clock_;
  logs::foxglove::Sink& sink_;
  const logs::TypeLibrary& types_;
  std::set<std::string, std::less<>> raw_channels_;  ///< known channels, at most kRawChannelsMax
  logs::foxglove::Stream stream_;
  bus::Bus bus_;
};

}  // namespace vantage::tools
