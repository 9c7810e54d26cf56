#include "drivers/vicon/vrpn_session.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace vantage::drivers::vicon {
namespace {

constexpr Duration kPingPeriod = std::chrono::seconds(1);
constexpr std::string_view kControlSender = "VRPN Control";
constexpr std::int32_t kOwnId = 0;

}  // namespace

VrpnSession::VrpnSession(bool is_y_up, FrameSink sink)
    : is_y_up_(is_y_up),
      trackers_(is_y_up),
      assembly_([this, sink = std::move(sink)](const SeenFrame&) {
        trackers_.add_held(frame_stamp_us_, assembly_.frame());
        sink(assembly_.frame());
      }),
      stream_(2 * wire::vicon::kVrpnMessageBytesMax) {}

void VrpnSession::open(Moment now) {
  trackers_.clear();
  assembly_.clear();
  stream_.clear();
  version_.reset();
  senders_.clear();
  types_.clear();
  has_pose_type_ = false;
  is_introduced_ = false;
  frame_stamp_us_ = 0;
  outgoing.clear();
  wire::vicon::append_vrpn_cookie(outgoing);
  next_ping_ = now.steady + kPingPeriod;
}

bool VrpnSession::receive(Moment arrival, wire::vicon::Bytes bytes) {
  while (!bytes.empty()) {
    bytes = bytes.subspan(stream_.push(bytes));
    if (!version_ && !read_cookie()) {
      ++counts.broken_streams;
      return false;
    }
    while (version_) {
      wire::vicon::VrpnHeader header;
      const wire::vicon::Framed message = wire::vicon::next_vrpn_message(stream_.view(), header);
      if (message.state == wire::vicon::Framing::kBroken) {
        ++counts.broken_streams;
        return false;
      }
      if (message.state == wire::vicon::Framing::kNeedMore) {
        break;
      }
      on_message(arrival, header, message.body);
      stream_.consume(message.bytes);
    }
  }
  assembly_.pass_on_if_complete();
  return true;
}

bool VrpnSession::read_cookie() {
  // Wrong bytes are detected immediately, before all 24 have arrived.
  constexpr std::string_view kStart = "vrpn: ver. ";
  const wire::vicon::Bytes view = stream_.view();
  const std::size_t common = std::min(view.size(), kStart.size());
  if (!std::equal(kStart.begin(), kStart.begin() + static_cast<std::ptrdiff_t>(common),
                  view.begin())) {
    return false;
  }
  if (view.size() < wire::vicon::kVrpnCookieBytes) {
    return true;
  }
  version_ = wire::vicon::decode_vrpn_cookie(view);
  stream_.consume(wire::vicon::kVrpnCookieBytes);
  return version_ && version_->major == wire::vicon::kVrpnMajor;
}

void VrpnSession::learn(std::vector<Name>& names, std::int32_t id, std::string_view name) {
  const auto known =
      std::find_if(names.begin(), names.end(), [id](const Name& each) { return each.id == id; });
  if (known != names.end()) {
    known->name = name;
  } else if (names.size() < kNamesMax) {
    names.push_back({id, std::string(name)});
  }
}

const std::string* VrpnSession::find(const std::vector<Name>& names, std::int32_t id) {
  const auto known =
      std::find_if(names.begin(), names.end(), [id](const Name& each) { return each.id == id; });
  return known == names.end() ? nullptr : &known->name;
}

void VrpnSession::on_message(Moment arrival, const wire::vicon::VrpnHeader& header,
                             wire::vicon::Bytes payload) {
  if (has_pose_type_ && header.type == pose_type_) {
    on_pose(arrival, header, payload);
    return;
  }
  if (header.type != wire::vicon::kVrpnSenderDescription &&
      header.type != wire::vicon::kVrpnTypeDescription) {
    return;
  }
  const auto name = wire::vicon::decode_vrpn_name(payload);
  if (!name) {
    ++counts.broken_blocks;
    return;
  }
  if (header.type == wire::vicon::kVrpnTypeDescription) {
    learn(types_, header.sender, *name);
    if (*name == wire::vicon::kVrpnPoseType) {
      pose_type_ = header.sender;
      has_pose_type_ = true;
    }
    return;
  }
  learn(senders_, header.sender, *name);
  if (*name != kControlSender && !assembly_.is_open()) {
    assembly_.expect(*name);
  }
  if (!is_introduced_ && *name != kControlSender) {
    // A ping must give the name of the receiving body as the name of its sender.
    wire::vicon::append_vrpn_name(outgoing, wire::vicon::kVrpnSenderDescription, kOwnId, *name);
    wire::vicon::append_vrpn_name(outgoing, wire::vicon::kVrpnTypeDescription, kOwnId,
                                  wire::vicon::kVrpnPingType);
    is_introduced_ = true;
  }
}

void VrpnSession::on_pose(Moment arrival, const wire::vicon::VrpnHeader& header,
                          wire::vicon::Bytes payload) {
  const auto pose = wire::vicon::decode_vrpn_pose(payload);
  const std::string* name = find(senders_, header.sender);
  if (!pose || name == nullptr) {
    ++(pose ? counts.unnamed_bodies : counts.broken_blocks);
    return;
  }
  if (pose->sensor != 0) {
    return;  // the pose of a limb, not of the body
  }
  const std::int64_t stamp_us =
      std::int64_t{header.seconds} * 1'000'000 + std::int64_t{header.microseconds};
  if (trackers_.take(*name, stamp_us, *pose)) {
    return;
  }
  constexpr std::int64_t kSameFrame_us = VrpnTrackers::kSameFrame_us;
  const bool is_same_frame = assembly_.is_open() && !assembly_.frame().has(*name) &&
                             std::abs(stamp_us - frame_stamp_us_) <= kSameFrame_us;
  const bool is_late = !assembly_.is_open() && !assembly_.frame().has(*name) &&
                       std::abs(stamp_us - frame_stamp_us_) <= kSameFrame_us;
  if (is_late) {  // the frame was assumed complete; the next frame waits for this body
    assembly_.expect_late(*name);
    ++counts.late_blocks;
    return;
  }
  if (!is_same_frame) {
    assembly_.begin(arrival);
    frame_stamp_us_ = stamp_us;
    assembly_.frame().server_time_us = stamp_us;
  }
  SeenBody& body = assembly_.frame().add();
  body.name = *name;
  VrpnTrackers::place(body, *pose, is_y_up_);
}

void VrpnSession::on_time(Moment now) {
  assembly_.on_time(now);
  if (now.steady >= next_ping_) {
    next_ping_ = now.steady + kPingPeriod;
    if (is_introduced_) {
      wire::vicon::append_vrpn_message(outgoing, {0, 0, kOwnId, kOwnId}, {});
    }
  }
}

Duration VrpnSession::next_wake() const {
  return std::min(next_ping_, assembly_.next_wake().value_or(Duration::max()));
}

}  // namespace vantage::drivers::vicon
