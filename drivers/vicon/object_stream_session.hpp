#pragma once

#include "drivers/vicon/frame_assembly.hpp"
#include "drivers/vicon/session.hpp"
#include "wire/vicon/object_stream.hpp"

namespace vantage::drivers::vicon {

/// Receiver of Tracker's UDP object stream. It sends nothing; a frame consists of one or more
/// datagrams.
class ObjectStreamSession : public Session {
 public:
  ObjectStreamSession(bool is_y_up, FrameSink sink);

  void open(Moment now) override;
  /// Processes one datagram. A datagram of another protocol is dropped and counted as a broken
  /// stream. Returns false if the datagram is known to be from another product.
  [[nodiscard]] bool receive(Moment arrival, wire::vicon::Bytes datagram) override;
  void on_time(Moment now) override { assembly_.on_time(now); }
  [[nodiscard]] Duration next_wake() const override;

 private:
  bool is_y_up_;
  FrameAssembly assembly_;
  wire::vicon::ObjectBlock block_;
  std::optional<std::uint32_t> last_number_;  ///< number of the newest frame
};

}  // namespace vantage::drivers::vicon
