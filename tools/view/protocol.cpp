#include "tools/view/protocol.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/saturated_time.hpp"

namespace vantage::tools {
namespace {

using Json = nlohmann::json;

constexpr char kMessageData = 0x01;
constexpr char kTime = 0x02;
constexpr char kPlaybackState = 0x05;
constexpr char kPlaybackControl = 0x03;

template <class Unsigned>
void put(std::string& out, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    out.push_back(static_cast<char>(value >> (8 * i) & 0xFFU));
  }
}

template <class Unsigned>
Unsigned take(std::string_view& from) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    const auto byte = static_cast<Unsigned>(static_cast<unsigned char>(from[i]));
    value = static_cast<Unsigned>(value | static_cast<Unsigned>(byte << (8 * i)));
  }
  from.remove_prefix(sizeof(Unsigned));
  return value;
}

Json seconds_json(Time time) {
  const std::int64_t us = std::max<std::int64_t>(0, to_utime(time));
  return {{"sec", us / 1'000'000}, {"nsec", us % 1'000'000 * 1000}};
}

std::optional<std::uint32_t> id_of(const Json& value) {
  if (!value.is_number_unsigned() ||
      value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    return std::nullopt;
  }
  return value.get<std::uint32_t>();
}

Request subscribe(const Json& document) {
  Subscribe out;
  const Json list = document.value("subscriptions", Json::array());
  for (const Json& each : list) {
    const auto id = each.is_object() ? id_of(each.value("id", Json())) : std::nullopt;
    const auto channel = each.is_object() ? id_of(each.value("channelId", Json())) : std::nullopt;
    if (!id || !channel) {
      return Malformed{"subscribe: every subscription needs a numeric id and channelId"};
    }
    out.pairs.emplace_back(*id, *channel);
  }
  return out;
}

Request unsubscribe(const Json& document) {
  Unsubscribe out;
  const Json list = document.value("subscriptionIds", Json::array());
  for (const Json& each : list) {
    const auto id = id_of(each);
    if (!id) {
      return Malformed{"unsubscribe: subscriptionIds must be a list of numbers"};
    }
    out.ids.push_back(*id);
  }
  return out;
}

}  // namespace

std::string server_info_text(const ServerInfo& info, bool speaks_sdk) {
  Json document{{"op", "serverInfo"},
                {"name", info.name},
                {"capabilities", Json::array()},
                {"supportedEncodings", Json::array({"json"})},
                {"metadata", Json::object()},
                {"sessionId", info.session_id}};
  if (info.range) {
    document["capabilities"] = {"time"};
  }
  if (info.range && speaks_sdk) {
    document["capabilities"].push_back("playbackControl");
    document["dataStartTime"] = seconds_json(info.range->first);
    document["dataEndTime"] = seconds_json(info.range->second);
  }
  return document.dump();
}

std::string advertise_text(std::span<const ChannelInfo> channels) {
  Json list = Json::array();
  for (const ChannelInfo& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "json"},
                    {"schemaName", logs::foxglove::name_of(channel.schema)},
                    {"schemaEncoding", "jsonschema"},
                    {"schema", logs::foxglove::json_schema(channel.schema)}});
  }
  return Json{{"op", "advertise"}, {"channels", std::move(list)}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

std::string status_text(StatusLevel level, const std::string& message, const std::string& id) {
  return Json{
      {"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}, {"id", id}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string remove_status_text(const std::string& id) {
  return Json{{"op", "removeStatus"}, {"statusIds", Json::array({id})}}.dump();
}

std::string message_head(std::uint32_t subscription_id, Time time) {
  std::string out(1, kMessageData);
  put(out, subscription_id);
  put(out, nanoseconds_of(time));
  return out;
}

std::string time_frame(Time time) {
  std::string out(1, kTime);
  put(out, nanoseconds_of(time));
  return out;
}

std::string playback_state_frame(const PlaybackState& state) {
  std::string out(1, kPlaybackState);
  out.push_back(static_cast<char>(state.status));
  put(out, nanoseconds_of(state.time));
  put(out, std::bit_cast<std::uint32_t>(state.speed));
  out.push_back(state.did_seek ? 1 : 0);
  put(out, static_cast<std::uint32_t>(state.request_id.size()));
  return out + state.request_id;
}

Request parse_text(std::string_view frame) {
  const Json document = Json::parse(frame, nullptr, false);
  if (!document.is_object() || !document.contains("op") || !document["op"].is_string()) {
    return Malformed{"a text frame must be a JSON object with a string \"op\""};
  }
  const auto op = document["op"].get<std::string>();
  for (const char* list : {"subscriptions", "subscriptionIds"}) {
    if (document.contains(list) && !document[list].is_array()) {
      return Malformed{op + ": " + list + " must be a list"};
    }
  }
  if (op == "subscribe") {
    return subscribe(document);
  }
  if (op == "unsubscribe") {
    return unsubscribe(document);
  }
  return Declined{op};
}

Request parse_binary(std::string_view frame) {
  constexpr std::size_t kFixed = 1 + 1 + 4 + 1 + 8 + 4;
  if (frame.empty() || frame.front() != kPlaybackControl) {
    return Declined{"binary frame"};
  }
  if (frame.size() < kFixed) {
    return Malformed{"playback control: the frame is too short"};
  }
  std::string_view rest = frame.substr(1);
  PlaybackControl out;
  const auto command = take<std::uint8_t>(rest);
  out.speed = std::bit_cast<float>(take<std::uint32_t>(rest));
  const bool had_seek = take<std::uint8_t>(rest) != 0;
  const auto seek_ns = take<std::uint64_t>(rest);
  const auto id_length = take<std::uint32_t>(rest);
  if (command > 1 || !std::isfinite(out.speed) || out.speed <= 0.0F || id_length != rest.size()) {
    return Malformed{
        "playback control: the command must be 0 or 1, the speed above 0, and the id must have the "
        "stated length"};
  }
  out.play = command == 0;
  if (had_seek) {
    out.seek = from_utime(static_cast<std::int64_t>(seek_ns / 1000U));
  }
  out.request_id = std::string(rest);
  return out;
}

bool offers_our_protocol(std::string_view header) {
  while (!header.empty()) {
    const std::size_t comma = std::min(header.find(','), header.size());
    std::string_view offered = header.substr(0, comma);
    header.remove_prefix(std::min(comma + 1, header.size()));
    while (offered.starts_with(' ')) {
      offered.remove_prefix(1);
    }
    while (offered.ends_with(' ')) {
      offered.remove_suffix(1);
    }
    if (std::any_of(std::begin(kSubprotocols), std::end(kSubprotocols),
                    [&](const char* ours) { return offered == ours; })) {
      return true;
    }
  }
  return false;
}

}  // namespace vantage::tools
