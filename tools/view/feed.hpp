#pragma once

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/transport.hpp"
#include "logs/foxglove/stream.hpp"

namespace vantage::tools {

/// Hears everything on a bus and tells it to a Sink as viewers know it. Publishes nothing.
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
  logs::foxglove::Stream stream_;
  bus::Bus bus_;
};

}  // namespace vantage::tools
