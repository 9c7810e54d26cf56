#include "wire/qualisys/packet.hpp"

namespace vantage::wire::qualisys {
namespace {

constexpr std::size_t kComponentHeaderBytes = 8;

bool has_poses(Component component) {
  return component == Component::k6D || component == Component::k6DEuler ||
         component == Component::k6DResidual || component == Component::k6DEulerResidual;
}

bool has_euler(Component component) {
  return component == Component::k6DEuler || component == Component::k6DEulerResidual;
}

bool has_residual(Component component) {
  return component == Component::k6DResidual || component == Component::k6DEulerResidual;
}

std::size_t body_bytes(Component component) {
  return 4 * (3 + (has_euler(component) ? 3U : 9U) + (has_residual(component) ? 1U : 0U));
}

/// Calls `value` with a reference to each number of a body, in the order of the protocol. The
/// matrix is sent column by column.
template <class BodyType, class Visit>
void visit_numbers(Component component, BodyType& body, const Visit& value) {
  for (auto& coordinate : body.position_mm) {
    value(coordinate);
  }
  if (has_euler(component)) {
    for (auto& angle : body.euler_deg) {
      value(angle);
    }
  } else {
    for (Eigen::Index column = 0; column < 3; ++column) {
      for (Eigen::Index row = 0; row < 3; ++row) {
        value(body.world_from_body(row, column));
      }
    }
  }
  if (has_residual(component)) {
    value(body.residual_mm);
  }
}

/// Reads a component without its header. Returns false if its size contradicts its count.
bool read_component(Reader from, Component component, Frame& out) {
  const std::uint32_t count = from.count(body_bytes(component));
  out.drop_rate = from.u16();
  out.out_of_sync_rate = from.u16();
  if (!from.ok() || from.left() != std::size_t{count} * body_bytes(component)) {
    return false;
  }
  out.component = component;
  for (std::uint32_t i = 0; i < count; ++i) {
    visit_numbers(component, out.bodies.emplace_back(), [&](float& value) { value = from.f32(); });
  }
  return true;
}

void append_header(Writer& to, std::size_t bytes, PacketType type) {
  to.u32(static_cast<std::uint32_t>(kHeaderBytes + bytes));
  to.u32(static_cast<std::uint32_t>(type));
}

}  // namespace

Packet next_packet(Bytes stream) {
  if (stream.size() < kHeaderBytes) {
    return {};
  }
  Reader from(stream);
  const std::size_t size = from.u32();
  Packet out;
  out.type = static_cast<PacketType>(from.u32());
  if (size < kHeaderBytes || size > kPacketBytesMax) {
    out.state = vicon::Framing::kBroken;
  } else if (size <= stream.size()) {
    out.state = vicon::Framing::kWhole;
    out.body = stream.subspan(kHeaderBytes, size - kHeaderBytes);
    out.bytes = size;
  }
  return out;
}

void append_text(std::vector<std::uint8_t>& out, PacketType type, std::string_view text) {
  Writer to(out);
  append_header(to, text.size() + 1, type);
  to.text(text);
  to.u8(0);
}

void append_event(std::vector<std::uint8_t>& out, std::uint8_t event) {
  Writer to(out);
  append_header(to, 1, PacketType::kEvent);
  to.u8(event);
}

void append_no_more_data(std::vector<std::uint8_t>& out) {
  Writer to(out);
  append_header(to, 0, PacketType::kNoMoreData);
}

std::string_view text_of(Bytes body) {
  const std::string_view text(reinterpret_cast<const char*>(body.data()), body.size());
  return text.substr(0, text.find('\0'));
}

bool decode_frame(Bytes body, Frame& out) {
  out.bodies.clear();
  Reader from(body);
  out.time_us = from.i64();
  out.number = from.u32();
  const std::uint32_t components = from.count(kComponentHeaderBytes);
  for (std::uint32_t i = 0; i < components; ++i) {
    const std::size_t size = from.u32();
    const auto component = static_cast<Component>(from.u32());
    if (size < kComponentHeaderBytes) {
      return false;
    }
    const Bytes content = from.take(size - kComponentHeaderBytes);
    if (!from.ok()) {
      return false;
    }
    if (has_poses(component)) {
      return read_component(Reader(content), component, out);
    }
  }
  return false;
}

void append_frame(std::vector<std::uint8_t>& out, const Frame& frame) {
  const std::size_t content = 8 + frame.bodies.size() * body_bytes(frame.component);
  Writer to(out);
  append_header(to, 16 + kComponentHeaderBytes + content, PacketType::kData);
  to.i64(frame.time_us);
  to.u32(frame.number);
  to.u32(1);
  to.u32(static_cast<std::uint32_t>(kComponentHeaderBytes + content));
  to.u32(static_cast<std::uint32_t>(frame.component));
  to.u32(static_cast<std::uint32_t>(frame.bodies.size()));
  to.u16(frame.drop_rate);
  to.u16(frame.out_of_sync_rate);
  for (const Body& body : frame.bodies) {
    visit_numbers(frame.component, body, [&](float value) { to.f32(value); });
  }
}

}  // namespace vantage::wire::qualisys
