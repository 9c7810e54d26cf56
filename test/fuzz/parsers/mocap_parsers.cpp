#include "test/fuzz/parsers/mocap_parsers.hpp"

#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>

#include "wire/natnet/definitions.hpp"
#include "wire/natnet/frame.hpp"
#include "wire/qualisys/body_names.hpp"
#include "wire/qualisys/packet.hpp"

namespace vantage::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
namespace natnet = wire::natnet;
namespace qualisys = wire::qualisys;

constexpr std::array<natnet::Version, 5> kVersions{
    {{{3, 0, 0, 0}}, {{3, 1, 0, 0}}, {{4, 0, 0, 0}}, {{4, 1, 0, 0}}, {{4, 2, 0, 0}}}};

void require_kept(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

void read_natnet_payload(std::span<const std::uint8_t> payload, const natnet::Version& version) {
  static_cast<void>(natnet::decode_connect(payload));
  static_cast<void>(natnet::decode_server_info(payload));
  static_cast<void>(natnet::decode_request(payload));
  static_cast<void>(natnet::decode_response(payload));
  static_cast<void>(natnet::decode_echo_request(payload));
  static_cast<void>(natnet::decode_echo_response(payload));
  natnet::Definitions definitions;
  natnet::decode_definitions(payload, version, definitions);
  require_kept(definitions.bodies.size() <= payload.size() / 25, "definitions are bounded");
  natnet::Frame frame;
  if (natnet::decode_frame(payload, version, frame)) {
    require_kept(frame.bodies.size() <= payload.size() / 38, "bodies are bounded");
    Bytes again;
    if (natnet::append_frame(again, version, frame)) {
      natnet::Frame reread;
      require_kept(natnet::decode_frame(natnet::decode_packet(again)->payload, version, reread) &&
                       reread.number == frame.number && reread.flags == frame.flags &&
                       reread.sent_ticks == frame.sent_ticks &&
                       reread.bodies.size() == frame.bodies.size(),
                   "a frame is written as it was read");
    }
  }
}

}  // namespace

void fuzz_natnet(std::span<const std::uint8_t> input) {
  if (input.empty()) {
    return;
  }
  const natnet::Version& version = kVersions[input[0] % kVersions.size()];
  const auto packet = natnet::decode_packet(input.subspan(1));
  if (packet) {
    require_kept(packet->payload.size() + 5 <= input.size(), "a payload is within its datagram");
    read_natnet_payload(packet->payload, version);
  } else {
    read_natnet_payload(input.subspan(1), version);
  }
}

std::vector<Bytes> natnet_samples() {
  std::vector<Bytes> out;
  for (std::uint8_t version = 0; version < kVersions.size(); ++version) {
    natnet::Frame frame;
    frame.bodies.resize(2);
    frame.flags = natnet::kFlagDefinitionsChanged;
    out.push_back({version});
    natnet::append_frame(out.back(), kVersions[version], frame);
    out.push_back({version});
    natnet::append_definitions(out.back(), kVersions[version], {{1, "QUAD"}, {2, "ROVER"}});
    out.push_back({version});
    natnet::append_server_info(out.back(), {});
  }
  return out;
}

void fuzz_qtm(std::span<const std::uint8_t> input) {
  std::span<const std::uint8_t> stream = input;
  for (;;) {
    const qualisys::Packet packet = qualisys::next_packet(stream);
    if (packet.state != wire::vicon::Framing::kWhole) {
      break;
    }
    require_kept(packet.bytes >= qualisys::kHeaderBytes && packet.bytes <= stream.size(),
                 "a packet is within its stream");
    qualisys::Frame frame;
    if (qualisys::decode_frame(packet.body, frame)) {
      require_kept(frame.bodies.size() <= packet.body.size() / 24, "bodies are bounded");
      Bytes again;
      append_frame(again, frame);
      qualisys::Frame reread;
      require_kept(qualisys::decode_frame(qualisys::next_packet(again).body, reread) &&
                       reread.number == frame.number && reread.time_us == frame.time_us &&
                       reread.bodies.size() == frame.bodies.size(),
                   "a frame is written as it was read");
    }
    static_cast<void>(qualisys::decode_body_names(qualisys::text_of(packet.body)));
    stream = stream.subspan(packet.bytes);
  }
  const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
  if (const auto names = qualisys::decode_body_names(text)) {
    require_kept(names->size() <= text.size() / 7, "names are bounded");
  }
}

std::vector<Bytes> qtm_samples() {
  std::vector<Bytes> out;
  for (const auto component :
       {qualisys::Component::k6D, qualisys::Component::k6DEuler, qualisys::Component::k6DResidual,
        qualisys::Component::k6DEulerResidual}) {
    qualisys::Frame frame;
    frame.component = component;
    frame.bodies.resize(2);
    append_frame(out.emplace_back(), frame);
  }
  const std::string xml = qualisys::encode_body_names({"QUAD", "R & <D>"});
  append_text(out.emplace_back(), qualisys::PacketType::kXml, xml);
  out.emplace_back(xml.begin(), xml.end());
  append_text(out.emplace_back(), qualisys::PacketType::kCommand, "QTM RT Interface connected");
  qualisys::append_event(out.back(), 1);
  qualisys::append_no_more_data(out.back());
  return out;
}

}  // namespace vantage::test
