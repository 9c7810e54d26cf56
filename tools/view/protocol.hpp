#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "logs/foxglove/schema.hpp"

// Encoding and decoding of the Foxglove WebSocket protocol. Pure. Text frames are JSON objects with
// "op"; binary frames begin with an opcode byte and are little-endian after the opcode.
// Source: docs/spec.md of foxglove/ws-protocol, and the playback control of foxglove-sdk.

namespace vantage::tools {

/// Supported subprotocols, newest first. Only the first subprotocol has playback control.
inline constexpr const char* kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

struct ServerInfo {
  std::string name;
  std::string session_id;  ///< new at each start, so that clients detect a new server
  /// First and last instant of a log; nullopt: live.
  std::optional<std::pair<Time, Time>> range;
};

struct ChannelInfo {
  std::uint32_t id = 0;
  std::string topic;
  logs::foxglove::Schema schema{};
};

enum class StatusLevel { kInfo = 0, kWarning = 1, kError = 2 };

enum class PlaybackStatus : std::uint8_t { kPlaying = 0, kPaused = 1, kBuffering = 2, kEnded = 3 };

struct PlaybackState {
  PlaybackStatus status = PlaybackStatus::kPaused;
  Time time{};
  float speed = 1.0F;
  bool did_seek = false;
  std::string request_id;  ///< id of the answered request; empty if there is none
};

/// Each of these functions returns a text frame.
std::string server_info_text(const ServerInfo& info, bool speaks_sdk);
std::string advertise_text(std::span<const ChannelInfo> channels);
std::string status_text(StatusLevel level, const std::string& message, const std::string& id);
std::string remove_status_text(const std::string& id);

/// Each of these functions returns a binary frame. The payload of a message follows its head.
std::string message_head(std::uint32_t subscription_id, Time time);
std::string time_frame(Time time);
std::string playback_state_frame(const PlaybackState& state);

/// Requests of a client.
struct Subscribe {
  /// pairs of subscription id and channel id
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
struct PlaybackControl {
  bool play = false;
  float speed = 1.0F;
  std::optional<Time> seek;
  std::string request_id;
};
/// Well-formed request for a function that this server does not offer.
struct Declined {
  std::string what;
};
/// Frame that violates the protocol.
struct Malformed {
  std::string why;
};
using Request = std::variant<Subscribe, Unsubscribe, PlaybackControl, Declined, Malformed>;

Request parse_text(std::string_view frame);
Request parse_binary(std::string_view frame);

/// True if `header`, a comma-separated list of offered subprotocols, contains a supported one.
bool offers_our_protocol(std::string_view header);

}  // namespace vantage::tools
