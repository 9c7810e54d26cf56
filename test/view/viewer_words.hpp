#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/view/broker.hpp"
#include "tools/view/outbox.hpp"

// Messages between viewers and the server, composed by hand.

namespace vantage::tools::test {

using nlohmann::json;

inline Frame flow(std::size_t bytes) {
  return {Frame::Kind::kFlow, false, 1, std::string(bytes, 'x'), nullptr};
}
inline Frame state(std::uint32_t id, const std::string& content) {
  return {Frame::Kind::kState, false, id, content, nullptr};
}
inline Frame control(const std::string& content) {
  return {Frame::Kind::kControl, true, 0, content, nullptr};
}

/// Returns the bytes of a playback control request, as a client composes them.
inline std::string playback_request(std::uint8_t command, float speed, bool had_seek,
                                    std::uint64_t seek_ns, const std::string& id) {
  std::string out("\x03", 1);
  const auto put = [&](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      out.push_back(static_cast<char>(value >> (8 * i) & 0xFFU));
    }
  };
  put(command, 1);
  put(std::bit_cast<std::uint32_t>(speed), 4);
  put(had_seek ? 1 : 0, 1);
  put(seek_ns, 8);
  put(id.size(), 4);
  return out + id;
}

inline json pop_text(Client& client) {
  const auto frame = client.wait_pop();
  EXPECT_TRUE(frame && frame->is_text);
  return frame ? json::parse(frame->head) : json();
}

/// Subscribes with id 7 to the topic `name` among those in `advertised`.
inline void subscribe(Broker& broker, Client& client, const json& advertised,
                      const std::string& topic) {
  for (const json& channel : advertised["channels"]) {
    if (channel["topic"] == topic) {
      broker.on_request(client, Subscribe{{{7, channel["id"].get<std::uint32_t>()}}});
    }
  }
}

inline void put(Broker& broker, const std::string& topic, int value, bool is_state) {
  if (broker.wants(topic, logs::foxglove::Schema::kTeam, is_state)) {
    broker.write(topic, from_utime(value), json{{"known", value}});
  }
}

}  // namespace vantage::tools::test
