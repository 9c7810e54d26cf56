#include "test/fuzz/bus/packet_path.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <vantage_lcm/attack_t.hpp>
#include <vantage_lcm/belief_t.hpp>
#include <vantage_lcm/collision_t.hpp>
#include <vantage_lcm/command_t.hpp>
#include <vantage_lcm/compact_belief_t.hpp>
#include <vantage_lcm/health_t.hpp>
#include <vantage_lcm/host_t.hpp>
#include <vantage_lcm/map_t.hpp>
#include <vantage_lcm/measurement_t.hpp>
#include <vantage_lcm/mixture_t.hpp>
#include <vantage_lcm/mocap_frame_t.hpp>
#include <vantage_lcm/plan_t.hpp>
#include <vantage_lcm/proposal_t.hpp>
#include <vantage_lcm/scan_t.hpp>
#include <vantage_lcm/scenario_t.hpp>
#include <vantage_lcm/team_proposal_t.hpp>
#include <vantage_lcm/truth_t.hpp>
#include <vantage_lcm/vehicle_t.hpp>

#include "bus/convert/wire_walk.hpp"
#include "bus/transport/udpm_packet.hpp"
#include "bus/transport/udpm_reassembly.hpp"
#include "logs/file/log_event.hpp"
#include "test/fuzz/bus/datagram_input.hpp"

namespace vantage::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

void promise(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

/// Checks that a decoded message is encoded to the same number of bytes. (The bytes may differ:
/// lcm-gen's encoder ends a string at the first NUL inside it.)
template <class Wire>
void decode_as(std::span<const std::uint8_t> bytes) {
  const auto wire = bus::decode_wire<Wire>(bytes);
  if (!wire) {
    return;
  }
  Bytes again(static_cast<std::size_t>(wire->getEncodedSize()));
  wire->encode(again.data(), 0, static_cast<int>(again.size()));
  promise(again.size() == bytes.size(), "what decodes takes as many bytes again");
}

template <class... Wires>
struct Types {
  static void decode(std::span<const std::uint8_t> bytes) { (decode_as<Wires>(bytes), ...); }
  template <class Take>
  static void each(const Take& take) {
    (take(Wires{}), ...);
  }
};
using All = Types<vantage_lcm::attack_t, vantage_lcm::belief_t, vantage_lcm::collision_t,
                  vantage_lcm::command_t, vantage_lcm::compact_belief_t, vantage_lcm::health_t,
                  vantage_lcm::host_t, vantage_lcm::map_t, vantage_lcm::measurement_t,
                  vantage_lcm::mixture_t, vantage_lcm::plan_t, vantage_lcm::proposal_t,
                  vantage_lcm::vehicle_t, vantage_lcm::scan_t, vantage_lcm::scenario_t,
                  vantage_lcm::team_proposal_t, vantage_lcm::truth_t, vantage_lcm::mocap_frame_t>;

void deliver(std::string_view channel, std::span<const std::uint8_t> bytes) {
  promise(!channel.empty() && channel.size() <= bus::udpm::kChannelBytesMax, "channels have names");
  promise(channel.find('\0') == std::string_view::npos, "names have no NUL inside");
  All::decode(bytes);
  if (!logs::is_event_channel(channel)) {
    return;
  }
  Bytes log;
  logs::append_event({7, from_utime(1), channel, bytes}, log);
  const auto event = logs::event_at(log, 0);
  promise(event && event->channel == channel && event->size_bytes() == log.size() &&
              std::equal(event->data.begin(), event->data.end(), bytes.begin(), bytes.end()),
          "what is logged is read");
  promise(logs::event_bytes_at(log, 0) == log.size(), "an event ends where it ends");
}

void put_number(std::size_t value, std::size_t width, Bytes& out) {
  for (std::size_t i = width; i > 0; --i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * (i - 1))));
  }
}

/// Appends one datagram of an input.
void put_datagram(std::uint8_t who, const bus::udpm::PacketHead& head,
                  std::span<const std::uint8_t> payload, Bytes& input) {
  input.push_back(who);
  put_number(head.bytes().size() + payload.size(), 2, input);
  input.insert(input.end(), head.bytes().begin(), head.bytes().end());
  input.insert(input.end(), payload.begin(), payload.end());
}

}  // namespace

void fuzz_packet_path(std::span<const std::uint8_t> input) {
  constexpr std::int64_t kStepNs = 40'000'000;
  const bus::udpm::ReassemblyLimits limits{.message_bytes_max = 4'096,
                                           .source_bytes_max = 16'384,
                                           .total_bytes_max = 65'536,
                                           .messages_max = 16};
  bus::udpm::Reassembler reassembler(limits);
  std::int64_t now_ns = 0;
  while (const auto datagram = take_datagram(input)) {
    const std::uint8_t control = datagram->control;
    now_ns += kStepNs * (control >> 4U);
    const auto packet = bus::udpm::parse_packet(datagram->bytes);
    if (!packet) {
      continue;
    }
    if (!packet->is_fragment) {
      deliver(packet->channel, packet->payload);
      continue;
    }
    if (const auto message = reassembler.add(control & 15U, *packet, now_ns)) {
      promise(message->payload.size() <= limits.message_bytes_max, "messages are bounded");
      deliver(message->channel, message->payload);
    }
    reassembler.expire(now_ns);
    promise(reassembler.bytes_kept() <= limits.total_bytes_max, "memory is bounded");
    promise(reassembler.messages_kept() <= limits.messages_max, "messages kept are bounded");
  }
  reassembler.expire(now_ns + std::int64_t{1'000'000'000'000});
  promise(reassembler.bytes_kept() == 0 && reassembler.messages_kept() == 0, "nothing leaks");
}

std::vector<std::vector<std::uint8_t>> packet_path_samples() {
  using bus::udpm::PacketHead;
  std::vector<Bytes> samples;
  All::each([&](const auto& wire) {
    Bytes message(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(message.data(), 0, static_cast<int>(message.size()));
    Bytes whole;
    put_datagram(0x01, PacketHead::of_short(1, "CHANNEL"), message, whole);
    samples.push_back(whole);
    const std::size_t half = message.size() / 2;
    const auto size = static_cast<std::uint32_t>(message.size());
    const auto first = std::span(message).first(half);
    const auto second = std::span(message).subspan(half);
    const PacketHead heads[2] = {
        PacketHead::of_fragment(1, size, 0, 0, 2, "CHANNEL"),
        PacketHead::of_fragment(1, size, static_cast<std::uint32_t>(half), 1, 2, "")};
    Bytes in_order;
    put_datagram(0x01, heads[0], first, in_order);
    put_datagram(0x01, heads[1], second, in_order);
    samples.push_back(in_order);
    Bytes mixed;
    put_datagram(0x01, heads[1], second, mixed);
    put_datagram(0x02, heads[0], first, mixed);
    put_datagram(0x11, heads[1], second, mixed);
    put_datagram(0x01, heads[0], first, mixed);
    samples.push_back(mixed);
  });
  return samples;
}

}  // namespace vantage::test
