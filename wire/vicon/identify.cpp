#include "wire/vicon/identify.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "wire/vicon/datastream.hpp"
#include "wire/vicon/object_stream.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::wire::vicon {
namespace {

constexpr std::string_view kVrpnStart = "vrpn: ver. ";
constexpr std::string_view kQualisysStart = "QTM RT Interface";
constexpr std::size_t kQualisysHeaderBytes = 8;  // bytes; size and type of the packet
constexpr std::size_t kBytesToDecide = 8;
constexpr double kCoordinateMax_mm = 1e7;

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_printable(char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\n' || c == '\t'; }

bool has_common_start(std::string_view a, std::string_view b) {
  const std::size_t common = std::min(a.size(), b.size());
  return a.substr(0, common) == b.substr(0, common);
}

/// True if counts, sizes and numbers are plausible for an object stream. Random data very rarely
/// pass this test.
bool is_object_block(Bytes datagram) {
  ObjectBlock block;
  return decode_object_block(datagram, block) && !block.is_truncated && block.skipped_items == 0 &&
         !block.objects.empty() &&
         std::all_of(block.objects.begin(), block.objects.end(), [](const TrackerObject& object) {
           return object.translation_mm.allFinite() && object.euler_xyz_rad.allFinite() &&
                  object.translation_mm.cwiseAbs().maxCoeff() < kCoordinateMax_mm;
         });
}

}  // namespace

ServerType identify_stream(Bytes first_bytes) {
  const std::string_view text = text_of(first_bytes);
  if (first_bytes.empty()) {
    return ServerType::kTooFewBytes;
  }
  if (next_packet(first_bytes).state != Framing::kBroken) {
    return first_bytes.size() < 4 ? ServerType::kTooFewBytes : ServerType::kDataStream;
  }
  if (has_common_start(text, kVrpnStart)) {
    return text.size() < kVrpnStart.size() ? ServerType::kTooFewBytes : ServerType::kVrpn;
  }
  if (text.size() > kQualisysHeaderBytes &&
      has_common_start(text.substr(kQualisysHeaderBytes), kQualisysStart)) {
    return ServerType::kQualisys;
  }
  const std::string_view head = text.substr(0, kBytesToDecide);
  if (std::all_of(head.begin(), head.end(), is_printable)) {
    return ServerType::kText;
  }
  return first_bytes.size() < kBytesToDecide ? ServerType::kTooFewBytes : ServerType::kUnknown;
}

ServerType identify_datagram(Bytes datagram) {
  if (datagram.size() >= 4 && next_packet(datagram).state != Framing::kBroken) {
    return ServerType::kDataStream;
  }
  if (decode_vrpn_callback(datagram)) {
    return ServerType::kVrpn;
  }
  return is_object_block(datagram) ? ServerType::kObjectStream : ServerType::kUnknown;
}

const char* name_of(ServerType server_type) {
  switch (server_type) {
    case ServerType::kUnknown:
      return "something unknown";
    case ServerType::kTooFewBytes:
      return "a server that sends too few bytes to be identified";
    case ServerType::kDataStream:
      return "a Vicon DataStream server";
    case ServerType::kVrpn:
      return "a VRPN server";
    case ServerType::kObjectStream:
      return "Vicon Tracker's UDP object stream";
    case ServerType::kNatNet:
      return "OptiTrack Motive";
    case ServerType::kQualisys:
      return "Qualisys Track Manager";
    case ServerType::kText:
      return "a server that sends text (not motion capture)";
  }
  return "something unknown";
}

}  // namespace vantage::wire::vicon
