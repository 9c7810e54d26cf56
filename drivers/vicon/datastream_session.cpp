#include "drivers/vicon/datastream_session.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <Eigen/Geometry>

#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::vicon {
namespace {

/// Time between pings, short enough that FrameClock does not mistake a pause of the server for a
/// queue of kQueuedMax.
constexpr Duration kPingPeriod = std::chrono::milliseconds(50);
/// Frames without poses are accepted after this time: no body is visible, or the server has no
/// poses.
constexpr Duration kJunkMax = std::chrono::milliseconds(300);
constexpr std::size_t kOutgoingMax = std::size_t{64} << 10U;
constexpr Duration kRequestPeriod = std::chrono::seconds(1);
constexpr std::array<std::uint32_t, 3> kSegmentTypes{
    wire::vicon::kGlobalSegments, wire::vicon::kLocalSegments, wire::vicon::kLightweightSegments};
constexpr std::array<std::uint32_t, 6> kWanted{
    wire::vicon::kStreamInfo,  wire::vicon::kSubjectInfo,     wire::vicon::kFrameInfo,
    wire::vicon::kLatencyInfo, wire::vicon::kApplicationInfo, wire::vicon::kContents};

bool contains(const std::vector<std::uint32_t>& types, std::uint32_t type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

bool is_segments(std::uint32_t type) {
  return std::find(kSegmentTypes.begin(), kSegmentTypes.end(), type) != kSegmentTypes.end();
}

}  // namespace

DataStreamSession::DataStreamSession(scenario::StreamMode mode, scenario::UpAxis up_axis,
                                     FrameSink sink)
    : mode_(mode),
      up_axis_(up_axis),
      sink_(std::move(sink)),
      stream_buffer_(wire::vicon::kPacketBytesMax) {}

void DataStreamSession::open(Moment now) {
  stream_buffer_.clear();
  outgoing.clear();
  offered_.types.clear();
  contents_ = {};
  stream_ = {};
  application_ = {};
  frame_ = {wire::vicon::FrameInfo::kNoFrame};
  has_latency_ = false;
  has_set_ = false;
  subjects_.clear();
  echo_.reset();
  opened_ = last_request_ = now;
  next_wake_ = Duration::max();
}

bool DataStreamSession::is_y_up() const {
  return up_axis_ == scenario::UpAxis::kAsTold ? application_.is_y_up
                                               : up_axis_ == scenario::UpAxis::kY;
}

bool DataStreamSession::receive(Moment arrival, wire::vicon::Bytes bytes) {
  const bool is_usable =
      stream_buffer_.receive(bytes, wire::vicon::next_packet, [&](const auto& packet) {
        on_packet(arrival, packet.body);
        return true;
      });
  counts.broken_streams += is_usable ? 0 : 1;
  return is_usable;
}

template <class Value>
void DataStreamSession::send(const Value& value) {
  if (outgoing.size() > kOutgoingMax) {
    return;  // the server sends requests but does not read
  }
  wire::vicon::PacketWriter packet(outgoing);
  append(packet, value);
  packet.finish();
}

template <class Value>
bool DataStreamSession::read(const wire::vicon::Block& block, Value& value) {
  if (decode(block.body, value)) {
    return true;
  }
  ++counts.broken_blocks;
  return false;
}

void DataStreamSession::on_packet(Moment arrival, wire::vicon::Bytes body) {
  bool has_static = false;
  bool has_dynamic = false;
  bool has_enums = false;
  contents_.sent.clear();
  contents_.unchanged.clear();
  wire::vicon::BlockCursor cursor(body);
  while (const auto block = cursor.next()) {
    has_static = has_static || wire::vicon::is_static(block->type);
    has_dynamic = has_dynamic || wire::vicon::is_dynamic(block->type);
    if (block->type == wire::vicon::kObjectEnums) {
      has_enums = read(*block, offered_) || has_enums;
    } else if (block->type == wire::vicon::kContents) {
      read(*block, contents_);
    } else if (wire::vicon::Ping ping; block->type == wire::vicon::kPing && read(*block, ping)) {
      on_ping(arrival, ping);
    }
  }
  counts.broken_blocks += cursor.is_broken() ? 1 : 0;
  if (has_enums) {
    request_content();
    request_frame(true);
    last_request_ = arrival;
    next_wake_ = arrival.steady + kPingPeriod;
  }
  if (has_static) {
    read_static(body);
  }
  if (has_dynamic) {
    read_dynamic(body);
    pass_on(arrival);
    if (mode_ != scenario::StreamMode::kPush) {
      request_frame(false);
      last_request_ = arrival;
    }
  }
}

// The id of a ping is its sending time, so that round trips longer than the ping period can also be
// measured.
void DataStreamSession::on_ping(Moment arrival, const wire::vicon::Ping& ping) {
  const Duration sent{static_cast<std::int64_t>(ping.id)};
  if (sent >= opened_.steady && sent <= arrival.steady) {
    echo_ = {sent, arrival.steady};
  }
}

void DataStreamSession::request_content() {
  segments_type_ = 0;
  for (const std::uint32_t type : kSegmentTypes) {
    segments_type_ = segments_type_ == 0 && contains(offered_.types, type) ? type : segments_type_;
  }
  wire::vicon::ObjectEnums wanted;
  for (const std::uint32_t type : offered_.types) {
    if (type == segments_type_ ||
        std::find(kWanted.begin(), kWanted.end(), type) != kWanted.end()) {
      wanted.types.push_back(type);
    }
  }
  std::sort(wanted.types.begin(), wanted.types.end());
  send(wanted);
}

void DataStreamSession::request_frame(bool is_first) {
  switch (mode_) {
    case scenario::StreamMode::kPush:
      if (is_first) {
        send(wire::vicon::RequestFrame{true});
      }
      break;
    case scenario::StreamMode::kPull:
      send(wire::vicon::RequestFrame{false});
      break;
    case scenario::StreamMode::kPreFetch:
      send(wire::vicon::RequestNextFrame{1});
      break;
  }
}

void DataStreamSession::on_time(Moment now) {
  if (now.steady < next_wake_) {
    return;
  }
  next_wake_ = now.steady + kPingPeriod;
  send(wire::vicon::Ping{static_cast<std::uint64_t>(now.steady.count())});
  if (now.steady - last_request_.steady >= kRequestPeriod && mode_ != scenario::StreamMode::kPush) {
    request_frame(false);  // the answer was lost, or the server paused
    last_request_ = now;
  }
}

void DataStreamSession::read_static(wire::vicon::Bytes packet) {
  std::size_t subjects = 0;
  wire::vicon::BlockCursor cursor(packet);
  while (const auto block = cursor.next()) {
    if (block->type == wire::vicon::kSubjectInfo && read(*block, subject_info_)) {
      on_subject(subjects++, subject_info_);
    } else if (block->type == wire::vicon::kStreamInfo) {
      read(*block, stream_);
    } else if (block->type == wire::vicon::kApplicationInfo) {
      read(*block, application_);
    }
  }
  // Static content without subjects means that no subjects exist, unless the subjects are marked as
  // unchanged. Rate and axis keep their values until the server sends new values.
  if (subjects > 0 || !contents_.is_unchanged(wire::vicon::kSubjectInfo)) {
    subjects_.resize(subjects);
  }
}

void DataStreamSession::on_subject(std::size_t index, const wire::vicon::SubjectInfo& info) {
  if (index == subjects_.size()) {
    subjects_.emplace_back();
  }
  Subject& subject = subjects_[index];
  if (subject.id != info.subject_id || subject.name != info.name) {
    subject.seen.pose_state = PoseState::kAbsent;
  }
  subject.id = info.subject_id;
  subject.name = info.name;
  // In Tracker, an object's only segment has the name of the object. A skeleton is represented by
  // its root segment.
  const auto same_name = std::find_if(info.segments.begin(), info.segments.end(),
                                      [&](const auto& each) { return each.name == info.name; });
  const auto root = std::find_if(info.segments.begin(), info.segments.end(),
                                 [](const auto& each) { return each.parent_id == 0; });
  const auto chosen = same_name != info.segments.end() ? same_name : root;
  subject.body_segment = chosen != info.segments.end() ? chosen->id : 0;
}

void DataStreamSession::read_dynamic(wire::vicon::Bytes packet) {
  if (!contents_.is_unchanged(wire::vicon::kFrameInfo)) {
    frame_.frame_number = wire::vicon::FrameInfo::kNoFrame;
  }
  if (!contents_.is_unchanged(wire::vicon::kLatencyInfo)) {
    has_latency_ = false;
  }
  if (!contents_.is_unchanged(segments_type_)) {
    for (Subject& subject : subjects_) {
      subject.seen.pose_state = PoseState::kAbsent;
    }
  }
  wire::vicon::BlockCursor cursor(packet);
  while (const auto block = cursor.next()) {
    if (block->type == wire::vicon::kFrameInfo) {
      read(*block, frame_);
    } else if (block->type == wire::vicon::kLatencyInfo) {
      has_latency_ = read(*block, latency_);
    } else if (block->type == segments_type_) {
      has_set_ = true;
      read_segments(*block);
    }
  }
  has_set_ = has_set_ || std::any_of(contents_.sent.begin(), contents_.sent.end(),
                                     [](const auto& entry) { return is_segments(entry.type); });
}

void DataStreamSession::read_segments(const wire::vicon::Block& block) {
  if (block.type == wire::vicon::kLightweightSegments) {
    if (read(block, light_segments_)) {
      for (const auto& pose : light_segments_.poses) {
        const Eigen::Vector3d turn = pose.angle_axis_rad.cast<double>();
        const double angle_rad = turn.norm();
        const Eigen::AngleAxisd rotation(
            angle_rad, angle_rad > 0.0 ? (turn / angle_rad).eval() : Eigen::Vector3d::UnitX());
        set_segment(light_segments_.subject_id, pose.segment_id, pose.translation_mm.cast<double>(),
                    rotation.toRotationMatrix());
      }
    }
    return;
  }
  if (read(block, segments_)) {
    for (const auto& pose : segments_.poses) {
      set_segment(segments_.subject_id, pose.segment_id, pose.translation_mm, pose.world_from_body);
    }
  }
}

void DataStreamSession::set_segment(std::uint32_t subject_id, std::uint32_t segment,
                                    const Eigen::Vector3d& position_mm,
                                    const Eigen::Matrix3d& world_from_body) {
  const auto subject = std::find_if(subjects_.begin(), subjects_.end(),
                                    [&](const Subject& each) { return each.id == subject_id; });
  if (subject == subjects_.end()) {
    ++counts.unnamed_bodies;
    return;
  }
  if (subject->body_segment != segment) {
    return;  // the segment of a limb, not of the body
  }
  const bool is_zero =
      position_mm.isZero(0.0) && (world_from_body.isZero(0.0) || world_from_body.isIdentity(0.0));
  set_pose(subject->seen, kMetresPerMillimetre * position_mm,
           wire::vicon::rotation_from_matrix(world_from_body), is_zero, is_y_up());
}

void DataStreamSession::pass_on(Moment arrival) {
  if (frame_.frame_number == wire::vicon::FrameInfo::kNoFrame ||
      (!has_set_ && arrival.steady - opened_.steady < kJunkMax)) {
    ++counts.frames_before_set;
    return;
  }
  seen_.clear();
  seen_.arrival = arrival;
  seen_.number = frame_.frame_number;
  seen_.latency_s = has_latency_ ? std::optional(latency_.total_s()) : std::nullopt;
  seen_.rate_hz = stream_.rate_hz();
  seen_.echo = echo_;
  seen_.is_complete_list = true;
  for (const Subject& subject : subjects_) {
    SeenBody& body = seen_.add();
    body.name = subject.name;
    body.pose_state = subject.seen.pose_state;
    body.world_from_body = subject.seen.world_from_body;
  }
  sink_(seen_);
}

}  // namespace vantage::drivers::vicon
