#include "drivers/natnet/natnet_session.hpp"

#include <algorithm>
#include <utility>

#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::natnet {
namespace {

using vicon::Moment;
using wire::natnet::PacketId;

constexpr Duration kConnectPeriod = std::chrono::milliseconds(500);
constexpr Duration kDefinitionsPeriod = std::chrono::milliseconds(500);
/// Time between echo requests; the same as between the pings of a DataStream client.
constexpr Duration kEchoPeriod = std::chrono::milliseconds(50);
/// A unicast server stops sending to a client that sends nothing.
constexpr Duration kKeepAlivePeriod = std::chrono::seconds(1);
/// Newest protocol version that this client reads. A newer server answers in its own version.
constexpr wire::natnet::Version kNewest{{4, 2, 0, 0}};

}  // namespace

NatNetSession::NatNetSession(bool is_y_up, vicon::FrameSink sink)
    : is_y_up_(is_y_up), sink_(std::move(sink)) {}

void NatNetSession::open(Moment now) {
  outgoing.clear();
  server_.reset();
  definitions_.bodies.clear();
  has_definitions_ = false;
  waits_since_.reset();
  echo_.reset();
  opened_ = now.steady;
  connect_ = {kConnectPeriod, now.steady};
  definitions_request_ = {kDefinitionsPeriod, now.steady};
  wants_definitions_ = true;
  echo_request_ = {kEchoPeriod, now.steady};
  keep_alive_ = {kKeepAlivePeriod, now.steady};
}

std::optional<vicon::MulticastGroup> NatNetSession::group() const {
  if (!server_ || !server_->is_multicast) {
    return std::nullopt;
  }
  return vicon::MulticastGroup{server_->group, server_->data_port};
}

// Sends one request per call, because `outgoing` is one datagram.
void NatNetSession::on_time(Moment now) {
  if (!outgoing.empty()) {
    return;
  }
  const auto is_due = [now](Request& request) {
    if (now.steady < request.due) {
      return false;
    }
    request.due = now.steady + request.period;
    return true;
  };
  if (is_due(connect_)) {
    wire::natnet::Connect connect;
    connect.natnet = kNewest;
    append_connect(outgoing, PacketId::kConnect, connect);
  } else if (!server_) {
    return;
  } else if (wants_definitions_ && is_due(definitions_request_)) {
    append_empty(outgoing, PacketId::kDefinitionsRequest);
  } else if (is_due(echo_request_)) {
    // The stamp is the sending time, so that round trips longer than the period can also be
    // measured.
    wire::natnet::append_echo_request(outgoing, static_cast<std::uint64_t>(now.steady.count()));
  } else if (is_due(keep_alive_)) {
    append_empty(outgoing, PacketId::kKeepAlive);
  }
}

Duration NatNetSession::next_wake() const {
  if (!server_) {
    return connect_.due;
  }
  const Duration wake = std::min({connect_.due, echo_request_.due, keep_alive_.due});
  return wants_definitions_ ? std::min(wake, definitions_request_.due) : wake;
}

bool NatNetSession::receive(Moment arrival, wire::vicon::Bytes datagram) {
  const auto packet = wire::natnet::decode_packet(datagram);
  if (!packet) {
    ++counts.broken_streams;
    return true;  // the next datagram may be complete
  }
  switch (packet->id) {
    case PacketId::kServerInfo:
      return on_server_info(packet->payload);
    case PacketId::kDefinitions:
      on_definitions(packet->payload);
      return true;
    case PacketId::kEchoResponse:
      on_echo(arrival, packet->payload);
      return true;
    case PacketId::kFrame:
      on_frame(arrival, packet->payload);
      return true;
    case PacketId::kResponse:
    case PacketId::kText:
    case PacketId::kDisconnect:  // connect_ requests a new connection
    case PacketId::kUnknownRequest:
      return true;
    case PacketId::kConnect:
    case PacketId::kRequest:
    case PacketId::kDefinitionsRequest:
    case PacketId::kKeepAlive:
    case PacketId::kEchoRequest:
    case PacketId::kDiscovery:
      break;  // only clients send these packets
  }
  ++counts.broken_streams;
  return true;
}

bool NatNetSession::on_server_info(wire::vicon::Bytes payload) {
  const auto info = wire::natnet::decode_server_info(payload);
  if (info && info->natnet < wire::natnet::kVersionMin) {
    refusal = "speaks NatNet " + to_text(info->natnet) +
              "; version 3.0 or later is required: update Motive to 2.0 or later";
    return false;
  }
  if (!info || info->ticks_per_s == 0) {
    ++counts.broken_blocks;
    return true;
  }
  if (!server_ || server_->natnet != info->natnet || server_->ticks_per_s != info->ticks_per_s) {
    clock_.restart(info->ticks_per_s);
    has_definitions_ = false;
    wants_definitions_ = true;
  }
  server_ = info;
  return true;
}

void NatNetSession::on_definitions(wire::vicon::Bytes payload) {
  if (!server_) {
    ++counts.frames_before_set;
    return;
  }
  decode_definitions(payload, server_->natnet, received_);
  if (!received_.is_complete) {
    ++counts.broken_blocks;
    if (received_.bodies.empty()) {
      return;
    }
  }
  std::swap(definitions_, received_);
  has_definitions_ = true;
  wants_definitions_ = false;
  if (waits_since_) {
    pass_on(*std::exchange(waits_since_, std::nullopt));
  }
}

void NatNetSession::on_echo(Moment arrival, wire::vicon::Bytes payload) {
  const auto echo = wire::natnet::decode_echo_response(payload);
  if (!echo || !server_) {
    ++counts.broken_blocks;
    return;
  }
  const Duration sent{static_cast<std::int64_t>(echo->stamp)};
  if (sent < opened_ || sent > arrival.steady) {
    ++counts.broken_blocks;
    return;
  }
  echo_ = {sent, arrival.steady};
  clock_.on_echo(sent, arrival.steady, echo->server_ticks);
}

const std::string* NatNetSession::name_of(std::int32_t id, std::size_t hint) const {
  const auto& bodies = definitions_.bodies;
  if (hint < bodies.size() && bodies[hint].id == id) {
    return &bodies[hint].name;  // servers usually send bodies in the order of their definitions
  }
  const auto found = std::ranges::find(bodies, id, &wire::natnet::BodyDefinition::id);
  return found == bodies.end() ? nullptr : &found->name;
}

void NatNetSession::add_body(const wire::natnet::RigidBody& body, const std::string& name) {
  vicon::SeenBody& out = seen_.add();
  out.name = name;
  out.pose_state = vicon::PoseState::kAbsent;
  if (body.is_tracked) {
    const Eigen::Vector4d q = body.rotation_xyzw.cast<double>();
    const bool is_zero = body.position_m.isZero(0.0F) && q.isZero(0.0);
    set_pose(out, body.position_m.cast<double>(),
             wire::vicon::rotation_from_xyzw(q.x(), q.y(), q.z(), q.w()), is_zero, is_y_up_);
  }
}

void NatNetSession::on_frame(Moment arrival, wire::vicon::Bytes payload) {
  if (!server_) {
    ++counts.frames_before_set;
    return;
  }
  if (waits_since_) {
    ++counts.frames_before_set;  // the waiting frame is replaced by a newer one
    waits_since_.reset();
  }
  if (!decode_frame(payload, server_->natnet, frame_)) {
    ++counts.broken_blocks;
    return;
  }
  connect_.due = arrival.steady + connect_.period;
  if ((frame_.flags & wire::natnet::kFlagDefinitionsChanged) != 0) {
    has_definitions_ = false;
  }
  if (!has_definitions_) {
    wants_definitions_ = true;
    definitions_request_.due = arrival.steady;
  }
  if (has_definitions_) {
    pass_on(arrival);
  } else {
    waits_since_ = arrival;
  }
}

void NatNetSession::pass_on(Moment arrival) {
  seen_.clear();
  seen_.arrival = arrival;
  seen_.number = frame_.number;
  // Some cameras do not report the exposure; the latency then begins at the server.
  const std::uint64_t captured =
      frame_.exposed_ticks > 0 ? frame_.exposed_ticks : frame_.received_ticks;
  seen_.latency_s = clock_.seconds_between(captured, frame_.sent_ticks);
  seen_.sent = clock_.steady_at(frame_.sent_ticks);
  seen_.echo = echo_;
  seen_.is_complete_list = true;
  for (std::size_t i = 0; i < frame_.bodies.size(); ++i) {
    if (const std::string* name = name_of(frame_.bodies[i].id, i)) {
      add_body(frame_.bodies[i], *name);
    } else {
      ++counts.unnamed_bodies;
      wants_definitions_ = true;
    }
  }
  if (seen_.bodies().size() < definitions_.bodies.size()) {
    for (const wire::natnet::BodyDefinition& defined : definitions_.bodies) {
      if (!seen_.has(defined.name)) {
        seen_.add() = {defined.name, vicon::PoseState::kAbsent, {}};
      }
    }
  }
  sink_(seen_);
}

const vicon::SessionRow& natnet_row() {
  static const vicon::SessionRow kRow{
      scenario::MocapProtocol::kNatNet, wire::vicon::ServerType::kNatNet,
      [](const scenario::MocapSpec& spec,
         vicon::FrameSink sink) -> std::unique_ptr<vicon::Session> {
        return std::make_unique<NatNetSession>(spec.is_y_up(), std::move(sink));
      }};
  return kRow;
}

}  // namespace vantage::drivers::natnet
