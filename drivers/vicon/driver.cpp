#include "drivers/vicon/driver.hpp"

#include <algorithm>
#include <utility>

#include "wire/vicon/identify.hpp"

namespace vantage::drivers::vicon {
namespace {

constexpr Duration kBackOffMin = std::chrono::milliseconds(100);
constexpr Duration kBackOffMax = std::chrono::seconds(2);
constexpr Duration kOpeningMax = std::chrono::seconds(3);
/// A connection without data for this long is closed: a streaming server sends more often, and an
/// idle server answers pings.
constexpr Duration kSilenceMax = std::chrono::seconds(3);
constexpr Duration kNoFrameHint = std::chrono::seconds(2);
constexpr std::size_t kFirstBytes = 64;

/// Largest accepted distance from the prediction, divided by the separation; less than 0.5.
constexpr double kGateShare = 0.45;

/// Returns the remedy for a server of another product at this port.
std::string remedy_for(wire::vicon::ServerType server_type) {
  const auto spoken = protocol_of(server_type);
  return spoken ? std::string("; set mocap.protocol: ") + spoken->name() + ", or another mocap.port"
                : "; check mocap.host and mocap.port";
}

}  // namespace

GateSettings gate_of(const scenario::MocapSpec& spec, double separation_m) {
  GateSettings gate;
  if (separation_m > 0.0) {
    gate.predicted_max_m = kGateShare * separation_m;
  }
  gate.speed_max_mps = spec.gate_speed_mps;
  gate.turn_max_radps = spec.gate_turn_radps;
  gate.stuck_frames = spec.stuck_frames;
  return gate;
}

ViconDriver::ViconDriver(const scenario::MocapSpec& spec, FrameFilter::Publish publish,
                         double separation_m)
    : ViconDriver(spec, session_row(spec.protocol), std::move(publish), separation_m) {}

ViconDriver::ViconDriver(const scenario::MocapSpec& spec, const SessionRow& row,
                         FrameFilter::Publish publish, double separation_m)
    : spec_(spec),
      row_(row),
      is_datagram_(spec.protocol.is_datagram()),
      filter_(gate_of(spec, separation_m), from_seconds(spec.latency_s), std::move(publish)),
      session_(row.open(spec, [this](const SeenFrame& frame) { on_frame(frame); })),
      back_off_(kBackOffMin),
      status_("not yet connected") {
  first_bytes_.reserve(kFirstBytes);
}

ViconDriver::~ViconDriver() = default;

std::string ViconDriver::address() const {
  return is_datagram_ ? "UDP port " + std::to_string(port())
                      : host() + ":" + std::to_string(port());
}

bool ViconDriver::wants_open(Moment now) const {
  return state_ == State::kClosed && now.steady >= next_attempt_;
}

void ViconDriver::on_opening(Moment now) {
  state_ = State::kOpening;
  opening_since_ = now.steady;
  wants_close_ = false;
}

void ViconDriver::on_opened(Moment now) {
  state_ = State::kOpen;
  wants_close_ = false;
  last_received_ = opened_at_ = now.steady;
  frames_since_open_ = 0;
  first_bytes_.clear();
  ++link_counts_.connections;
  session_->refusal.clear();
  session_->open(now);
  filter_.on_opened();
  const bool has_answer = transport() != scenario::MocapTransport::kUdpRequested;
  status_ = (is_datagram_ ? "listening at "
             : has_answer ? "connected to "
                          : "waiting for ") +
            address() + ", no frame yet";
}

void ViconDriver::on_closed(Moment now, const std::string& why) {
  if (state_ == State::kOpening) {
    ++link_counts_.connections_failed;
  } else if (state_ == State::kOpen && !wants_close_) {
    ++link_counts_.connections_lost;
  }
  if (!wants_close_) {
    status_ = address() + ": " + why;
  }
  state_ = State::kClosed;
  wants_close_ = false;
  if (is_backlog_) {
    is_backlog_ = false;
    next_attempt_ = now.steady;
    return;
  }
  next_attempt_ = now.steady + back_off_;
  back_off_ = std::min(2 * back_off_, kBackOffMax);
}

void ViconDriver::close_because(const std::string& why) {
  wants_close_ = true;
  status_ = address() + " " + why;
}

void ViconDriver::receive(Moment arrival, wire::vicon::Bytes bytes) {
  if (state_ != State::kOpen || wants_close_) {
    return;
  }
  last_received_ = arrival.steady;
  if (!is_datagram_ && first_bytes_.size() < kFirstBytes) {
    const auto more = bytes.first(std::min(bytes.size(), kFirstBytes - first_bytes_.size()));
    first_bytes_.insert(first_bytes_.end(), more.begin(), more.end());
  }
  if (session_->receive(arrival, bytes)) {
    close_if_behind(arrival);
    return;
  }
  if (!session_->refusal.empty()) {
    close_because(session_->refusal);
    return;
  }
  using wire::vicon::ServerType;
  const ServerType server_type = is_datagram_ ? wire::vicon::identify_datagram(bytes)
                                              : wire::vicon::identify_stream(first_bytes_);
  const ServerType expected = row_.server_type;
  const std::string problem =
      server_type == expected ? std::string("sends bytes that its protocol does not allow")
                              : std::string("is ") + wire::vicon::name_of(server_type) + ", not " +
                                    wire::vicon::name_of(expected) + remedy_for(server_type);
  if (is_datagram_) {
    // other hosts may also send to this port: continue to receive
    status_ = address() + " " + problem;
  } else {
    close_because(problem);
  }
}

void ViconDriver::on_frame(const SeenFrame& frame) {
  if (frames_since_open_++ == 0) {
    back_off_ = kBackOffMin;
    status_ = "frames from " + address();
  }
  filter_.accept(frame);
}

void ViconDriver::close_if_behind(Moment now) {
  const bool may_close = !backlog_closed_ || now.steady - *backlog_closed_ >= kBacklogPeriod;
  if (!filter_.is_behind() || !may_close) {
    return;
  }
  backlog_closed_ = now.steady;
  is_backlog_ = true;
  ++link_counts_.backlogs;
  close_because("is " + std::to_string(filter_.waited().count() / 1'000) +
                " ms behind: frames wait in a queue; reconnecting to empty it; use a cable, "
                "or mocap.mode: pull");
}

void ViconDriver::on_time(Moment now) {
  if (state_ == State::kOpening && now.steady - opening_since_ > kOpeningMax && !wants_close_) {
    close_because("does not answer; check mocap.host, the cable and the firewall");
  }
  if (state_ != State::kOpen || wants_close_) {
    return;
  }
  session_->on_time(now);
  if (now.steady - last_received_ > kSilenceMax) {
    if (is_datagram_) {
      last_received_ = now.steady;  // the next report follows after kSilenceMax
      status_ = "no data received at " + address() +
                "; in Tracker, turn on the UDP object stream to this host and port";
    } else {
      ++link_counts_.silences;
      close_because(transport() == scenario::MocapTransport::kUdpRequested && first_bytes_.empty()
                        ? "does not answer; is streaming turned on, and are mocap.host, the cable "
                          "and the firewall right?"
                    : first_bytes_.empty()
                        ? "accepts the connection but sends nothing; is it a mocap server?"
                        : "has stopped sending");
    }
  } else if (frames_since_open_ == 0 && last_received_ > opened_at_ &&
             now.steady - opened_at_ > kNoFrameHint) {
    status_ = (is_datagram_ ? "data received at " : "connected to ") + address() +
              ", but no frames; is the system live, and are objects ticked? (Nexus: run "
              "the Kinematic Fit pipeline)";
  }
}

Duration ViconDriver::next_wake() const {
  switch (state_) {
    case State::kClosed:
      return next_attempt_;
    case State::kOpening:
      return opening_since_ + kOpeningMax + Duration{1};
    case State::kOpen:
      break;
  }
  return std::min(session_->next_wake(), last_received_ + kSilenceMax + Duration{1'000});
}

}  // namespace vantage::drivers::vicon
