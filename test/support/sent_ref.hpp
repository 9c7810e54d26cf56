#pragma once

#include "bus/node/bus.hpp"

namespace vantage::test {

/// Publishes `message` on `bus` and returns the reference to it.
template <class Message>
models::InputRef sent_ref(bus::Bus& bus, const bus::Channel<Message>& channel,
                          const Message& message) {
  return bus.ref_to(channel, bus.publish(channel, message));
}

}  // namespace vantage::test
