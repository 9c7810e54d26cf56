#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/vicon/session.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::drivers::vicon {

/// Client of Vicon's DataStream.
///
/// The server first announces its content. The client requests the content that contains poses, and
/// then frames: a stream or single frames, as `mode` selects. Content that a packet's Contents
/// block marks as unchanged is kept; other static content is replaced completely. A body is
/// occluded if it was described and has no pose in the frame.
class DataStreamSession : public Session {
 public:
  DataStreamSession(scenario::StreamMode mode, scenario::UpAxis up_axis, FrameSink sink);

  void open(Moment now) override;
  [[nodiscard]] bool receive(Moment arrival, wire::vicon::Bytes bytes) override;
  void on_time(Moment now) override;
  [[nodiscard]] Duration next_wake() const override { return next_wake_; }

  [[nodiscard]] double rate_hz() const { return stream_.rate_hz(); }
  [[nodiscard]] bool is_y_up() const;

 private:
  struct Subject {
    std::uint32_t id = 0;
    std::string name;
    std::uint32_t body_segment = 0;  ///< id of the segment that represents the subject
    SeenBody seen;                   ///< pose and its state, without the name
  };

  void on_ping(Moment arrival, const wire::vicon::Ping& ping);
  void on_packet(Moment arrival, wire::vicon::Bytes body);
  void read_static(wire::vicon::Bytes packet);
  void read_dynamic(wire::vicon::Bytes packet);
  void read_segments(const wire::vicon::Block& block);
  void set_segment(std::uint32_t subject, std::uint32_t segment, const Eigen::Vector3d& position_mm,
                   const Eigen::Matrix3d& world_from_body);
  void on_subject(std::size_t index, const wire::vicon::SubjectInfo& info);
  void pass_on(Moment arrival);
  void request_content();
  void request_frame(bool is_first);
  template <class Value>
  void send(const Value& value);
  template <class Value>
  bool read(const wire::vicon::Block& block, Value& value);

  scenario::StreamMode mode_;
  scenario::UpAxis up_axis_;
  FrameSink sink_;
  wire::vicon::StreamBuffer stream_buffer_;

  // Received from the server on this connection.
  wire::vicon::ObjectEnums offered_;
  std::uint32_t segments_type_ = 0;  ///< requested block type of segments: 9, 8 or 901
  wire::vicon::Contents contents_;
  wire::vicon::StreamInfo stream_;
  wire::vicon::ApplicationInfo application_;
  wire::vicon::FrameInfo frame_;
  wire::vicon::LatencyInfo latency_;
  bool has_latency_ = false;
  bool has_set_ = false;  ///< a frame with the requested content was received
  std::vector<Subject> subjects_;

  Moment opened_;
  Moment last_request_;
  Duration next_wake_{Duration::max()};
  std::optional<Echo> echo_;

  // Buffers; their memory is reused.
  wire::vicon::SubjectInfo subject_info_;
  wire::vicon::Segments segments_;
  wire::vicon::LightweightSegments light_segments_;
  SeenFrame seen_;
};

}  // namespace vantage::drivers::vicon
