#pragma once

#include <type_traits>
#include <utility>

#include "bus/convert/wire_walk.hpp"
#include "bus/node/bus.hpp"

namespace vantage::bus {

template <class Message>
Message Bus::publish(const Channel<Message>& channel, Message message) {
  const std::string name = publish_prefix_ + channel.name;
  message.stamp.run_id = run_id_;
  message.stamp.sequence = next_sequence(name);
  const WireOf<Message> wire = to_wire(message);
  const int size = wire.getEncodedSize();
  buffer_.resize(static_cast<std::size_t>(size));
  wire.encode(buffer_.data(), 0, size);
  if (authenticator_) {
    if constexpr (std::is_same_v<Message, models::OperatorCommand>) {
      seal(name, message.robot);
    } else {
      seal(name, "");
    }
  }
  send(name, buffer_);
  return message;
}

template <class Message>
void Bus::subscribe(const Channel<Message>& channel, std::function<void(const Message&)> handler) {
  subscribe_named<Message>(
      channel, [handler = std::move(handler)](const std::string& /*name*/, const Message& message) {
        handler(message);
      });
}

template <class Message>
void Bus::subscribe_named(const Channel<Message>& channel,
                          std::function<void(const std::string& name, const Message&)> handler) {
  subscribe_shared<Message>(
      channel, [handler = std::move(handler)](const std::string& name, const auto& message) {
        handler(name, *message);
      });
}

template <class Message>
std::shared_ptr<const Message> Bus::message_of(Delivery& delivery) {
  if (delivery.decoded != nullptr) {
    if (auto known = delivery.decoded->template get<Message>()) {
      return known;
    }
  }
  const auto wire = decode_wire<WireOf<Message>>(delivery.bytes);
  if (!wire) {
    undecoded_ += delivery.is_faulty ? 0 : 1;
    count_fault(delivery, decode_errors_);
    return nullptr;
  }
  std::optional<Message> message = from_wire(*wire);
  if (!message) {
    count_fault(delivery, refused_);
    return nullptr;
  }
  auto shared = std::make_shared<const Message>(std::move(*message));
  if (delivery.decoded != nullptr) {
    delivery.decoded->keep(shared);
  }
  return shared;
}

template <class Message>
void Bus::subscribe_shared(
    const Channel<Message>& channel,
    std::function<void(const std::string& name, const std::shared_ptr<const Message>&)> handler) {
  add_subscription({channel.name, channel.is_shared, channel.lease,
                    [this, handler = std::move(handler)](Delivery& delivery) {
                      constexpr bool kMayPass = std::is_same_v<Message, models::OperatorCommand>;
                      if (delivery.is_fresh == false && !kMayPass) {
                        return;
                      }
                      const std::shared_ptr<const Message> message = message_of<Message>(delivery);
                      if (!message) {
                        return;
                      }
                      bool may_pass =
                          is_fresh(delivery, message->stamp) || passes_every_filter(*message);
                      if constexpr (kMayPass) {
                        may_pass = is_addressed_to_us(delivery, *message) && may_pass;
                      }
                      if (may_pass) {
                        handler(delivery.name, message);
                      }
                    }});
}

}  // namespace vantage::bus
