#include "wire/vicon/vrpn.hpp"

#include <algorithm>
#include <charconv>

namespace vantage::wire::vicon {
namespace {

using BigReader = Reader<std::endian::big>;
using BigWriter = Writer<std::endian::big>;

constexpr std::string_view kCookieStart = "vrpn: ver. ";
constexpr std::size_t kAlignment = 8;
constexpr std::size_t kPosePayloadBytes = 64;
constexpr std::size_t kCallbackBytesMax = 80;

std::size_t padded(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }
int two_digits(std::string_view text) { return (text[0] - '0') * 10 + (text[1] - '0'); }

template <class Vector>
Vector vector_from(BigReader& from) {
  Vector vector;
  for (double& component : vector) {
    component = from.f64();
  }
  return vector;
}

template <class Vector>
void vector_to(const Vector& vector, BigWriter& to) {
  for (const double component : vector) {
    to.f64(component);
  }
}

void header_to(const VrpnHeader& header, std::size_t payload_bytes, BigWriter& to) {
  to.u32(static_cast<std::uint32_t>(kVrpnHeaderBytes + payload_bytes));
  to.u32(header.seconds);
  to.u32(header.microseconds);
  to.i32(header.sender);
  to.i32(header.type);
  to.u32(0);  // sequence number; receivers ignore it
}

}  // namespace

void append_vrpn_cookie(std::vector<std::uint8_t>& out, int minor) {
  const std::size_t start = out.size();
  BigWriter writer(out);
  writer.text(kCookieStart);
  writer.text("07.");
  writer.u8(static_cast<std::uint8_t>('0' + minor / 10 % 10));
  writer.u8(static_cast<std::uint8_t>('0' + minor % 10));
  writer.text("  0");
  writer.zeros(kVrpnCookieBytes - (out.size() - start));
}

std::optional<VrpnVersion> decode_vrpn_cookie(Bytes bytes) {
  BigReader reader(bytes);
  const std::string_view cookie = reader.text(kVrpnCookieBytes);
  if (cookie.substr(0, kCookieStart.size()) != kCookieStart) {
    return std::nullopt;
  }
  const std::string_view version = cookie.substr(kCookieStart.size(), 5);
  if (!is_digit(version[0]) || !is_digit(version[1]) || version[2] != '.' ||
      !is_digit(version[3]) || !is_digit(version[4])) {
    return std::nullopt;
  }
  return VrpnVersion{two_digits(version), two_digits(version.substr(3))};
}

Framed next_vrpn_message(Bytes stream, VrpnHeader& header) {
  if (stream.size() < 4) {
    return {Framing::kNeedMore, {}, 0};
  }
  BigReader reader(stream);
  const std::size_t length = reader.u32();
  if (length < kVrpnHeaderBytes || length > kVrpnMessageBytesMax) {
    return {Framing::kBroken, {}, 0};
  }
  if (stream.size() < padded(length)) {
    return {Framing::kNeedMore, {}, 0};
  }
  header.seconds = reader.u32();
  header.microseconds = reader.u32();
  header.sender = reader.i32();
  header.type = reader.i32();
  return {Framing::kWhole, stream.subspan(kVrpnHeaderBytes, length - kVrpnHeaderBytes),
          padded(length)};
}

void append_vrpn_message(std::vector<std::uint8_t>& out, const VrpnHeader& header, Bytes payload) {
  BigWriter writer(out);
  header_to(header, payload.size(), writer);
  out.insert(out.end(), payload.begin(), payload.end());
  writer.zeros(padded(payload.size()) - payload.size());
}

std::optional<std::string_view> decode_vrpn_name(Bytes payload) {
  BigReader reader(payload);
  std::string_view name = reader.text(reader.count(1));
  name = name.substr(0, std::min(name.find('\0'), name.size()));
  if (!reader.ok() || name.empty() || name.size() > kVrpnNameBytesMax) {
    return std::nullopt;
  }
  return name;
}

void append_vrpn_name(std::vector<std::uint8_t>& out, std::int32_t type, std::int32_t id,
                      std::string_view name) {
  const std::size_t payload_bytes = sizeof(std::uint32_t) + name.size() + 1;
  BigWriter writer(out);
  header_to({0, 0, id, type}, payload_bytes, writer);
  writer.u32(static_cast<std::uint32_t>(name.size() + 1));
  writer.text(name);
  writer.zeros(1 + padded(payload_bytes) - payload_bytes);
}

std::optional<VrpnPose> decode_vrpn_pose(Bytes payload) {
  if (payload.size() != kPosePayloadBytes) {
    return std::nullopt;
  }
  BigReader reader(payload);
  VrpnPose pose;
  pose.sensor = reader.i32();
  reader.i32();  // skips the padding
  pose.position_m = vector_from<Eigen::Vector3d>(reader);
  pose.quaternion_xyzw = vector_from<decltype(pose.quaternion_xyzw)>(reader);
  return pose;
}

void append_vrpn_pose(std::vector<std::uint8_t>& out, const VrpnHeader& header,
                      const VrpnPose& pose) {
  BigWriter writer(out);
  header_to(header, kPosePayloadBytes, writer);
  writer.i32(pose.sensor);
  writer.i32(0);
  vector_to(pose.position_m, writer);
  vector_to(pose.quaternion_xyzw, writer);
}

std::optional<VrpnCallback> decode_vrpn_callback(Bytes datagram) {
  BigReader reader(datagram.first(std::min(datagram.size(), kCallbackBytesMax)));
  std::string_view text = reader.text(reader.left());
  text = text.substr(0, std::min(text.find('\0'), text.size()));
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos || space == 0) {
    return std::nullopt;
  }
  const std::string_view digits = text.substr(space + 1);
  VrpnCallback callback{std::string(text.substr(0, space)), 0};
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), callback.port);
  if (error != std::errc() || end != digits.data() + digits.size() || callback.port < 1 ||
      callback.port > 65535) {
    return std::nullopt;
  }
  return callback;
}

void append_vrpn_callback(std::vector<std::uint8_t>& out, const VrpnCallback& callback) {
  BigWriter writer(out);
  writer.text(callback.address);
  writer.text(" ");
  writer.text(std::to_string(callback.port));
  writer.u8(0);
}

}  // namespace vantage::wire::vicon
