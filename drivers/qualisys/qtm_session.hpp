#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/vicon/session.hpp"
#include "drivers/vicon/session_table.hpp"
#include "wire/qualisys/body_names.hpp"
#include "wire/qualisys/packet.hpp"
#include "wire/vicon/stream_buffer.hpp"

namespace vantage::drivers::qualisys {

/// Client of the real-time protocol of Qualisys Track Manager (QTM).
///
/// After the greeting, the client agrees on the newest version that both sides know, requests the
/// names of the bodies and then all frames with rotation matrices. An event of the server may mean
/// that bodies have changed: the names are requested again, and the newest frame waits for them.
/// Frames are requested again when none arrive. The stamps of QTM begin at zero with each
/// measurement; FrameClock relates them to the clock of this host. Version requests, which the
/// server answers in the order of its frames, serve as pings.
class QtmSession : public vicon::Session {
 public:
  QtmSession(bool is_y_up, vicon::FrameSink sink);

  void open(vicon::Moment now) override;
  [[nodiscard]] bool receive(vicon::Moment arrival, wire::vicon::Bytes bytes) override;
  void on_time(vicon::Moment now) override;
  [[nodiscard]] Duration next_wake() const override;

 private:
  enum class State { kGreeting, kVersion, kNames, kStreaming };

  void send(std::string_view command);
  [[nodiscard]] bool on_packet(vicon::Moment arrival, const wire::qualisys::Packet& packet);
  [[nodiscard]] bool on_answer(vicon::Moment arrival, std::string_view text);
  [[nodiscard]] bool on_version(std::string_view text);
  void on_names(std::string_view xml);
  void request_names();
  void on_frame(vicon::Moment arrival, wire::vicon::Bytes body);
  void pass_on(vicon::Moment arrival);

  bool is_y_up_;
  vicon::FrameSink sink_;
  wire::vicon::StreamBuffer stream_;

  State state_ = State::kGreeting;
  std::size_t version_ = 0;                   ///< index of the requested version
  std::vector<std::string> all_names_;        ///< names of all bodies
  std::vector<std::string> enabled_names_;    ///< names of the bodies that are tracked
  bool is_waiting_ = false;                   ///< names were requested
  std::optional<vicon::Moment> waits_since_;  ///< arrival of `frame_` if it waits for names
  std::deque<Duration> pings_;                ///< sending times of unanswered pings
  std::optional<vicon::Echo> echo_;
  Duration ping_due_{};
  Duration retry_due_{};  ///< time of the next request of names or frames

  // Buffers; their memory is reused.
  wire::qualisys::Frame frame_;
  vicon::SeenFrame seen_;
};

/// Returns the protocol of this driver.
const vicon::SessionRow& qtm_row();

}  // namespace vantage::drivers::qualisys
