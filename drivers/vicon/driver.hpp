#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/vicon/frame_filter.hpp"
#include "drivers/vicon/session.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::drivers::vicon {

struct LinkCounts {
  std::int64_t connections = 0;
  std::int64_t connections_failed = 0;
  std::int64_t connections_lost = 0;  ///< closed by the other side, or broken
  std::int64_t silences = 0;          ///< closed by us: nothing came for too long
  std::int64_t backlogs = 0;          ///< closed by us to empty a queue of frames
};

/// The whole driver but its sockets: connections, bytes and time in; frames, bytes and wishes out.
///
/// It wants the link open whenever it is not, for ever, waiting longer after each failure (0.1 s
/// doubling to 2 s; a frame resets that). It closes a connection whose frames wait in a queue, to
/// empty the queue, at most once per kBacklogPeriod, and connects again at once. The owner of the
/// socket does as wants_open() and wants_close() say and reports what happened.
class ViconDriver {
 public:
  static constexpr Duration kBacklogPeriod = std::chrono::seconds(5);

  /// @param publish  called with each good frame, within receive() or on_time()
  /// @param separation_m  that the scenario's plans keep between bodies; 0: not known
  ViconDriver(const scenario::MocapSpec& spec, FrameFilter::Publish publish,
              double separation_m = 0.0);
  ~ViconDriver();
  ViconDriver(const ViconDriver&) = delete;
  ViconDriver& operator=(const ViconDriver&) = delete;
  ViconDriver(ViconDriver&&) = delete;
  ViconDriver& operator=(ViconDriver&&) = delete;

  /// True when datagrams are to be heard at `port`; else a TCP connection is to be made.
  [[nodiscard]] bool is_datagram() const { return is_datagram_; }
  [[nodiscard]] const std::string& host() const { return spec_.host; }
  /// True when datagrams are taken from host() alone: the scenario names another than the default.
  [[nodiscard]] bool has_sender() const {
    return is_datagram_ && spec_.host != scenario::MocapSpec{}.host;
  }
  [[nodiscard]] int port() const { return spec_.actual_port(); }

  [[nodiscard]] bool wants_open(Moment now) const;
  [[nodiscard]] bool wants_close() const { return wants_close_; }
  /// An attempt to open has begun.
  void on_opening(Moment now);
  void on_opened(Moment now);
  /// The attempt failed, or the link is gone; `why` in words, for people.
  void on_closed(Moment now, const std::string& why);
  /// The next bytes of the stream, cut anywhere, or one datagram.
  void receive(Moment arrival, wire::vicon::Bytes bytes);
  void on_time(Moment now);
  /// The steady time by which on_time() wants to be called.
  [[nodiscard]] Duration next_wake() const;

  /// Bytes to send; the caller erases what it has sent.
  std::vector<std::uint8_t>& outgoing() { return session_->outgoing; }

  /// How it stands, in one sentence that says what to do where something can be done.
  [[nodiscard]] const std::string& status() const { return status_; }
  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }
  /// A frame has come on this connection.
  [[nodiscard]] bool has_frames() const { return is_open() && frames_since_open_ > 0; }
  [[nodiscard]] const LinkCounts& link_counts() const { return link_counts_; }
  [[nodiscard]] const WireCounts& wire_counts() const { return session_->counts; }
  [[nodiscard]] const FrameCounts& frame_counts() const { return filter_.counts(); }
  [[nodiscard]] std::vector<BodyRate> rates() const { return session_->rates(); }

 private:
  enum class State { kClosed, kOpening, kOpen };

  [[nodiscard]] std::string place() const;
  void close_because(const std::string& why);
  void on_frame(const SeenFrame& frame);
  void close_if_behind(Moment now);

  scenario::MocapSpec spec_;
  bool is_datagram_;
  FrameFilter filter_;
  std::unique_ptr<Session> session_;
  State state_ = State::kClosed;
  bool wants_close_ = false;
  bool is_backlog_ = false;  ///< why it wants to close
  std::optional<Duration> backlog_closed_;
  Duration next_attempt_{};
  Duration back_off_;
  Duration opening_since_{};
  Duration last_heard_{};
  Duration opened_at_{};
  std::int64_t frames_since_open_ = 0;
  std::vector<std::uint8_t> first_bytes_;  ///< of this connection, to tell who speaks
  std::string status_;
  LinkCounts link_counts_;
};

}  // namespace vantage::drivers::vicon
