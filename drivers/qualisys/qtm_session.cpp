#include "drivers/qualisys/qtm_session.hpp"

#include <array>
#include <utility>

#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::qualisys {
namespace {

using vicon::Moment;
using wire::qualisys::PacketType;
using wire::vicon::Framing;

constexpr std::string_view kGreeting = "QTM RT Interface connected";
/// Versions that this client knows, the newest first. All have the same layout of frames.
constexpr std::array<std::string_view, 5> kVersions{"1.25", "1.21", "1.16", "1.12", "1.8"};
/// Time between pings; the same as between the pings of a DataStream client.
constexpr Duration kPingPeriod = std::chrono::milliseconds(50);
constexpr Duration kRetryPeriod = std::chrono::seconds(1);
constexpr std::size_t kPingsMax = 64;
constexpr std::size_t kOutgoingMax = std::size_t{64} << 10U;

}  // namespace

QtmSession::QtmSession(bool is_y_up, vicon::FrameSink sink)
    : is_y_up_(is_y_up), sink_(std::move(sink)), stream_(wire::qualisys::kPacketBytesMax) {}

void QtmSession::open(Moment now) {
  stream_.clear();
  outgoing.clear();
  state_ = State::kGreeting;
  version_ = 0;
  all_names_.clear();
  enabled_names_.clear();
  is_waiting_ = false;
  waits_since_.reset();
  pings_.clear();
  echo_.reset();
  ping_due_ = now.steady;
  retry_due_ = now.steady + kRetryPeriod;
}

void QtmSession::send(std::string_view command) {
  if (outgoing.size() <= kOutgoingMax) {
    append_text(outgoing, PacketType::kCommand, command);
  }
}

Duration QtmSession::next_wake() const {
  switch (state_) {
    case State::kGreeting:
    case State::kVersion:
      return Duration::max();
    case State::kNames:
      return retry_due_;
    case State::kStreaming:
      break;
  }
  return std::min(ping_due_, retry_due_);
}

void QtmSession::on_time(Moment now) {
  if (state_ == State::kGreeting || state_ == State::kVersion) {
    return;
  }
  if (now.steady >= retry_due_) {
    retry_due_ = now.steady + kRetryPeriod;
    if (state_ == State::kNames || is_waiting_) {
      request_names();
    } else {
      send("StreamFrames AllFrames 6DRes");
    }
  }
  if (state_ == State::kStreaming && now.steady >= ping_due_) {
    ping_due_ = now.steady + kPingPeriod;
    if (pings_.size() < kPingsMax) {
      pings_.push_back(now.steady);
      send("QTMVersion");
    }
  }
}

bool QtmSession::receive(Moment arrival, wire::vicon::Bytes bytes) {
  const bool is_usable =
      stream_.receive(bytes, wire::qualisys::next_packet,
                      [&](const auto& packet) { return on_packet(arrival, packet); });
  counts.broken_streams += is_usable ? 0 : 1;
  return is_usable;
}

bool QtmSession::on_packet(Moment arrival, const wire::qualisys::Packet& packet) {
  const std::string_view text = wire::qualisys::text_of(packet.body);
  if (state_ == State::kGreeting) {
    if (packet.type != PacketType::kCommand || !text.starts_with(kGreeting)) {
      return false;
    }
    state_ = State::kVersion;
    send("Version " + std::string(kVersions[version_]));
    return true;
  }
  switch (packet.type) {
    case PacketType::kError:
    case PacketType::kCommand:
      return state_ == State::kVersion ? on_version(text) : on_answer(arrival, text);
    case PacketType::kXml:
      on_names(text);
      return true;
    case PacketType::kData:
      on_frame(arrival, packet.body);
      return true;
    case PacketType::kNoMoreData:
      retry_due_ = std::min(retry_due_, arrival.steady + kRetryPeriod / 4);
      return true;
    case PacketType::kEvent:
      if (state_ == State::kStreaming && !is_waiting_) {
        request_names();
      }
      return true;
  }
  ++counts.broken_blocks;  // a type of a later version
  return true;
}

bool QtmSession::on_version(std::string_view text) {
  if (text == "Version set to " + std::string(kVersions[version_])) {
    state_ = State::kNames;
    request_names();
    return true;
  }
  if (++version_ == kVersions.size()) {
    refusal = "speaks no known version of QTM's protocol; version 1.8 or later is required";
    return false;
  }
  send("Version " + std::string(kVersions[version_]));
  return true;
}

bool QtmSession::on_answer(Moment arrival, std::string_view text) {
  if (text.starts_with("QTM Version") && !pings_.empty()) {
    echo_ = {pings_.front(), arrival.steady};
    pings_.pop_front();
  } else if (text != "Ok") {
    ++counts.broken_blocks;  // an error; the request is repeated
  }
  return true;
}

void QtmSession::request_names() {
  is_waiting_ = true;
  send("GetParameters 6D");
}

void QtmSession::on_names(std::string_view xml) {
  const auto bodies = wire::qualisys::decode_body_names(xml);
  if (!bodies) {
    ++counts.broken_blocks;
    return;
  }
  all_names_.clear();
  enabled_names_.clear();
  for (const wire::qualisys::BodyName& body : *bodies) {
    all_names_.push_back(body.name);
    if (body.is_enabled) {
      enabled_names_.push_back(body.name);
    }
  }
  is_waiting_ = false;
  if (state_ == State::kNames) {
    state_ = State::kStreaming;
    send("StreamFrames AllFrames 6DRes");
  }
  if (waits_since_) {
    pass_on(*std::exchange(waits_since_, std::nullopt));
  }
}

void QtmSession::on_frame(Moment arrival, wire::vicon::Bytes body) {
  if (state_ != State::kStreaming) {
    ++counts.frames_before_set;
    return;
  }
  if (waits_since_) {
    ++counts.frames_before_set;  // the waiting frame is replaced by a newer one
    waits_since_.reset();
  }
  if (!decode_frame(body, frame_)) {
    ++counts.broken_blocks;
    return;
  }
  if (is_waiting_) {
    waits_since_ = arrival;  // the names are requested again at retry_due_
    return;
  }
  retry_due_ = arrival.steady + kRetryPeriod;
  pass_on(arrival);
}

void QtmSession::pass_on(Moment arrival) {
  const std::vector<std::string>& names =
      frame_.bodies.size() == all_names_.size() ? all_names_ : enabled_names_;
  if (names.size() != frame_.bodies.size()) {
    counts.unnamed_bodies += static_cast<std::int64_t>(frame_.bodies.size());
    if (!is_waiting_) {
      request_names();
      retry_due_ = arrival.steady + kRetryPeriod;
    }
    return;
  }
  seen_.clear();
  seen_.arrival = arrival;
  seen_.number = frame_.number;
  seen_.server_time_us = frame_.time_us;
  seen_.echo = echo_;
  seen_.is_complete_list = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const wire::qualisys::Body& body = frame_.bodies[i];
    vicon::SeenBody& out = seen_.add();
    out.name = names[i];
    out.pose_state = vicon::PoseState::kAbsent;
    if (body.position_mm.allFinite()) {
      const Eigen::Matrix3d world_from_body = body.world_from_body.cast<double>();
      set_pose(out, vicon::kMetresPerMillimetre * body.position_mm.cast<double>(),
               wire::vicon::rotation_from_matrix(world_from_body),
               body.position_mm.isZero(0.0F) && world_from_body.isZero(0.0), is_y_up_);
    }
  }
  sink_(seen_);
}

const vicon::SessionRow& qtm_row() {
  static const vicon::SessionRow kRow{
      scenario::MocapProtocol::kQtm, wire::vicon::ServerType::kQualisys,
      [](const scenario::MocapSpec& spec,
         vicon::FrameSink sink) -> std::unique_ptr<vicon::Session> {
        return std::make_unique<QtmSession>(spec.is_y_up(), std::move(sink));
      }};
  return kRow;
}

}  // namespace vantage::drivers::qualisys
