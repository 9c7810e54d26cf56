#include "test/fuzz/parsers/stream_parsers.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <tuple>

#include "logs/file/log_event.hpp"
#include "logs/file/log_scan.hpp"
#include "tools/view/origin_check.hpp"
#include "tools/view/protocol.hpp"
#include "wire/crtp/flight.hpp"
#include "wire/crtp/link_uri.hpp"
#include "wire/crtp/system.hpp"
#include "wire/crtp/tables.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/signing.hpp"

namespace vantage::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using wire::mavlink::Frame;
constexpr Time kNow = from_utime(1'767'225'600'000'000);

void promise(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

template <class... Messages>
void unpack_all(const Frame& frame, std::tuple<Messages...>*) {
  (static_cast<void>(wire::mavlink::unpack<Messages>(frame)), ...);
}

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace

void fuzz_mavlink(std::span<const std::uint8_t> input) {
  if (input.empty()) {
    return;
  }
  const std::size_t chunk = input[0] < 128 ? input.size() : std::size_t{input[0]} % 64 + 1;
  input = input.subspan(1);
  wire::mavlink::Parser parser;
  wire::mavlink::SequenceMonitor sequence;
  wire::mavlink::Signer signer(wire::mavlink::SigningKey{1, 2, 3}, 0);
  std::size_t frame_bytes = 0;
  const auto take = [&](const Frame& frame) {
    Bytes again;
    wire::mavlink::append_bytes(frame, again);
    frame_bytes += again.size();
    promise(again.size() <= 280, "a frame has its bounds");
    sequence.on_frame(frame.origin);
    unpack_all(frame, static_cast<wire::mavlink::AllMessages*>(nullptr));
    promise(frame.signature.has_value() ||
                signer.check(frame, kNow) == wire::mavlink::SignatureVerdict::kUnsigned,
            "what is unsigned is not good");
    static_cast<void>(signer.check(frame, kNow));
  };
  for (std::size_t at = 0; at < input.size(); at += chunk) {
    const std::span<const std::uint8_t> piece = input.subspan(at);
    const Bytes own(piece.begin(),
                    piece.begin() + static_cast<std::ptrdiff_t>(std::min(chunk, piece.size())));
    parser.feed(own, take);
  }
  parser.flush(take);
  const auto skipped = static_cast<std::size_t>(parser.counts().bytes_skipped);
  promise(skipped + frame_bytes <= input.size(), "no byte is read twice");
}

std::vector<Bytes> mavlink_samples() {
  wire::mavlink::Signer signer(wire::mavlink::SigningKey{1, 2, 3}, 0);
  std::vector<Bytes> samples;
  const auto add = [&](const auto& message) {
    for (const bool is_signed : {false, true}) {
      Frame frame = wire::mavlink::pack(message, {1, 1, 0});
      if (is_signed) {
        signer.sign(frame, kNow);
      }
      Bytes sample{static_cast<std::uint8_t>(is_signed ? 200 : 0)};
      wire::mavlink::append_bytes(frame, sample);
      samples.push_back(std::move(sample));
    }
  };
  std::apply([&](const auto&... each) { (add(each), ...); }, wire::mavlink::AllMessages{});
  return samples;
}

void fuzz_crtp(std::span<const std::uint8_t> input) {
  namespace crtp = wire::crtp;
  const std::string text(input.begin(), input.end());
  static_cast<void>(crtp::parse_link_uri(text));
  const auto packet = crtp::decode(input);
  promise(packet.has_value() == (!input.empty() && input.size() <= crtp::kPacketMax),
          "a packet has its bounds");
  if (!packet) {
    return;
  }
  const crtp::Encoded again = crtp::encode(*packet, input[0] & crtp::kClientLinkBits);
  promise(std::ranges::equal(again.bytes(), input), "a packet keeps its bytes");
  if (const auto message = crtp::decode_flight(*packet)) {
    std::visit(
        [](const auto& content) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(content)>,
                                        std::vector<crtp::PackedPose>>) {
            static_cast<void>(crtp::encode(content));
          } else {
            promise(content.size() <= crtp::kPackedPosesMax, "a packet holds two poses");
          }
        },
        *message);
  }
  static_cast<void>(crtp::decode_high_level_reply(*packet));
  static_cast<void>(crtp::decode_supervisor_request(*packet));
  static_cast<void>(crtp::decode_info_reply(*packet));
  static_cast<void>(crtp::decode_protocol_reply(*packet));
  static_cast<void>(crtp::decode_platform_text(*packet, crtp::PlatformRequest::kFirmware));
  static_cast<void>(crtp::decode_console(*packet));
  static_cast<void>(crtp::decode_log_reply(*packet));
  for (const crtp::Port port : {crtp::Port::kParameter, crtp::Port::kLog}) {
    static_cast<void>(crtp::decode_toc_info(port, *packet));
    if (const auto item = crtp::decode_toc_item(port, *packet)) {
      promise(item->group.size() + item->name.size() < crtp::kPayloadMax, "names are short");
    }
  }
  for (int type = 0; type < 8; ++type) {
    static_cast<void>(crtp::decode_parameter_reply(*packet, static_cast<crtp::ValueType>(type)));
  }
  if (auto data = crtp::decode_log_data(*packet)) {
    promise(data->values.size() <= crtp::kLogBytesMax, "a log block has its bounds");
    while (crtp::take_value(data->values, crtp::ValueType::kF16)) {
    }
  }
}

std::vector<Bytes> crtp_samples() {
  namespace crtp = wire::crtp;
  std::vector<Bytes> samples;
  const auto add = [&](const std::optional<crtp::Packet>& packet) {
    const crtp::Encoded encoded = crtp::encode(packet.value());
    samples.emplace_back(encoded.bytes().begin(), encoded.bytes().end());
  };
  const std::array<crtp::PackedPose, 2> poses{};
  const std::array<crtp::LogVariable, 2> variables{};
  add(crtp::encode(crtp::ExternalPose{}));
  add(crtp::encode(std::span<const crtp::PackedPose>(poses)));
  add(crtp::encode(crtp::FullStateSetpoint{}));
  add(crtp::encode(crtp::PositionSetpoint{}));
  add(crtp::encode(crtp::SetpointsEnd{}));
  add(crtp::encode(crtp::HighLevelHeight{}));
  add(crtp::encode(crtp::HighLevelGoTo{}));
  add(crtp::arm_request(true));
  add(crtp::info_reply(0x20E));
  add(crtp::protocol_reply(12));
  add(crtp::source_reply());
  add(crtp::toc_info_reply(crtp::Port::kLog, {380, 1}));
  add(crtp::toc_item_reply(crtp::Port::kParameter,
                           {1, crtp::ValueType::kF32, false, "kalman", "varX"}));
  add(crtp::parameter_write(1, crtp::ValueType::kF32, 1.0));
  add(crtp::log_create(1, variables));
  add(crtp::log_reply({6, 1, 0}));
  samples.push_back(bytes_of("radio://0/80/2M/E7E7E7E7E7"));
  samples.push_back(bytes_of("udp://127.0.0.1:19850"));
  return samples;
}

void fuzz_log(std::span<const std::uint8_t> input) {
  const Bytes log(input.begin(), input.end());
  logs::LogScan scan(log);
  std::size_t events = 0;
  std::size_t end = 0;
  std::size_t sound_bytes = 0;
  while (const auto event = scan.next()) {
    promise(event->offset >= end, "events come in order, and do not overlap");
    end = event->offset + event->size_bytes();
    promise(end <= log.size(), "events are inside");
    promise(!event->channel.empty(), "channels have names");
    sound_bytes += event->size_bytes();
    ++events;
  }
  promise(events <= log.size() / logs::kEventHeaderBytes, "the scan ends");
  promise(scan.counts().bytes_damaged + sound_bytes == log.size(), "each byte is accounted for");
}

std::vector<Bytes> log_samples() {
  Bytes log;
  std::vector<Bytes> samples;
  for (std::int64_t i = 0; i < 6; ++i) {
    logs::append_event(
        {i, from_utime(i), i % 2 == 0 ? "VICON" : "A", Bytes(static_cast<std::size_t>(7 * i), 3)},
        log);
    samples.push_back(log);
  }
  Bytes inside;
  logs::append_event({6, from_utime(6), "LOG", log}, inside);
  logs::append_event({7, from_utime(7), "B", {}}, inside);
  samples.push_back(inside);
  inside.resize(inside.size() - 9);
  samples.push_back(inside);
  return samples;
}

void fuzz_viewer(std::span<const std::uint8_t> input) {
  const std::string text(input.begin(), input.end());
  static_cast<void>(tools::parse_text(text));
  static_cast<void>(tools::parse_binary(text));
  static_cast<void>(tools::offers_our_protocol(text));
  const std::array<std::string, 1> more{"lab"};
  static_cast<void>(tools::is_our_host(text, more));
  const std::size_t cut = text.find('\n');
  const std::string host = cut == std::string::npos ? "lab:8765" : text.substr(cut + 1);
  if (tools::is_known_origin(text.substr(0, cut), host, {})) {
    promise(text.find("://") != std::string::npos, "an origin has a scheme");
  }
}

std::vector<Bytes> viewer_samples() {
  std::vector<Bytes> samples;
  for (const char* text :
       {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})",
        R"({"op":"unsubscribe","subscriptionIds":[1,2]})", R"({"op":"fetchAsset","uri":"x"})",
        R"({"op":"subscribe","channels":[{"id":1,"channelId":2}]})", "lab:8765", "[::1]:8765",
        "http://lab:8765\nlab:8765", "https://app.foxglove.dev\n127.0.0.1:8765",
        "foxglove.sdk.v1, foxglove.websocket.v1"}) {
    samples.push_back(bytes_of(text));
  }
  for (std::uint8_t opcode = 0; opcode < 5; ++opcode) {
    Bytes binary(40, 1);
    binary[0] = opcode;
    samples.push_back(binary);
  }
  return samples;
}

}  // namespace vantage::test
