#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/vicon/frame_filter.hpp"
#include "drivers/vicon/session.hpp"
#include "drivers/vicon/session_table.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::drivers::vicon {

struct LinkCounts {
  std::int64_t connections = 0;
  std::int64_t connections_failed = 0;
  std::int64_t connections_lost = 0;  ///< connections closed by the server, or broken
  std::int64_t silences = 0;          ///< connections closed here because nothing was received
  std::int64_t backlogs = 0;          ///< connections closed here to empty a queue of frames
};

/// Returns the settings of the gate for a mocap system. `separation_m`: as for ViconDriver.
GateSettings gate_of(const scenario::MocapSpec& spec, double separation_m);

/// Driver of a mocap server, without sockets. Connection events, bytes and time are passed in; the
/// driver returns frames, bytes to send, and requests to open or close the connection.
///
/// It requests a connection whenever no connection exists. The wait after a failure doubles from
/// 0.1 s to 2 s; a received frame resets it. If frames wait in a queue, the driver closes the
/// connection to empty the queue, at most once per kBacklogPeriod, and reconnects immediately. The
/// owner of the socket obeys wants_open() and wants_close() and reports the result.
class ViconDriver {
 public:
  static constexpr Duration kBacklogPeriod = std::chrono::seconds(5);

  /// Creates a driver of one of the protocols of session_table.cpp. @throws StartupError for
  /// another protocol.
  ViconDriver(const scenario::MocapSpec& spec, FrameFilter::Publish publish,
              double separation_m = 0.0);
  /// @param row  protocol of `spec`
  /// @param publish  called with each accepted frame, within receive() or on_time()
  /// @param separation_m  distance that the scenario's plans keep between bodies, m; 0: unknown
  ViconDriver(const scenario::MocapSpec& spec, const SessionRow& row, FrameFilter::Publish publish,
              double separation_m = 0.0);
  ~ViconDriver();
  ViconDriver(const ViconDriver&) = delete;
  ViconDriver& operator=(const ViconDriver&) = delete;
  ViconDriver(ViconDriver&&) = delete;
  ViconDriver& operator=(ViconDriver&&) = delete;

  /// True if datagrams are received at `port`; otherwise a TCP connection is used.
  [[nodiscard]] bool is_datagram() const { return is_datagram_; }
  [[nodiscard]] scenario::MocapTransport transport() const { return spec_.protocol.transport(); }
  [[nodiscard]] std::optional<MulticastGroup> group() const {
    return is_open() ? session_->group() : std::nullopt;
  }
  [[nodiscard]] const std::string& host() const { return spec_.host; }
  /// True if only datagrams from host() are accepted: the scenario names a host other than the
  /// default.
  [[nodiscard]] bool has_sender() const {
    return is_datagram_ && spec_.host != scenario::MocapSpec{}.host;
  }
  [[nodiscard]] int port() const { return spec_.actual_port(); }

  [[nodiscard]] bool wants_open(Moment now) const;
  [[nodiscard]] bool wants_close() const { return wants_close_; }
  /// Reports that an attempt to open has begun.
  void on_opening(Moment now);
  void on_opened(Moment now);
  /// Reports that the attempt failed or the connection was lost; `why` is a text for the status.
  void on_closed(Moment now, const std::string& why);
  /// Processes the next bytes of the stream, split at any position, or one datagram.
  void receive(Moment arrival, wire::vicon::Bytes bytes);
  void on_time(Moment now);
  /// Returns the steady time at which on_time() must be called.
  [[nodiscard]] Duration next_wake() const;

  /// Returns the bytes to send; the caller erases what it has sent.
  std::vector<std::uint8_t>& outgoing() { return session_->outgoing; }

  /// Returns the status in one sentence, with the remedy where there is one.
  [[nodiscard]] const std::string& status() const { return status_; }
  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }
  /// True if any data were received on this connection.
  [[nodiscard]] bool has_data() const { return is_open() && last_received_ > opened_at_; }
  /// True if a frame was received on this connection.
  [[nodiscard]] bool has_frames() const { return is_open() && frames_since_open_ > 0; }
  [[nodiscard]] const LinkCounts& link_counts() const { return link_counts_; }
  [[nodiscard]] const WireCounts& wire_counts() const { return session_->counts; }
  [[nodiscard]] const FrameCounts& frame_counts() const { return filter_.counts(); }
  [[nodiscard]] std::vector<BodyRate> rates() const { return session_->rates(); }

 private:
  enum class State { kClosed, kOpening, kOpen };

  [[nodiscard]] std::string address() const;
  void close_because(const std::string& why);
  void on_frame(const SeenFrame& frame);
  void close_if_behind(Moment now);

  scenario::MocapSpec spec_;
  const SessionRow& row_;
  bool is_datagram_;
  FrameFilter filter_;
  std::unique_ptr<Session> session_;
  State state_ = State::kClosed;
  bool wants_close_ = false;
  bool is_backlog_ = false;  ///< wants_close_ is set because of a backlog
  std::optional<Duration> backlog_closed_;
  Duration next_attempt_{};
  Duration back_off_;
  Duration opening_since_{};
  Duration last_received_{};
  Duration opened_at_{};
  std::int64_t frames_since_open_ = 0;
  std::vector<std::uint8_t> first_bytes_;  ///< first bytes received, which identify the server
  std::string status_;
  LinkCounts link_counts_;
};

}  // namespace vantage::drivers::vicon
