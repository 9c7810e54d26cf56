// The bytes of the emulated Vicon servers, decoded again: bodies, units, axes, times, and occluded
// bodies.

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/vicon/datastream_peer.hpp"
#include "sim/vicon/object_stream_server.hpp"
#include "sim/vicon/vrpn_peer.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

namespace wire = vantage::wire::vicon;
using Bytes = std::vector<std::uint8_t>;

/// Returns two bodies that differ in all values; the second is occluded.
EmulatedFrame frame_of(std::uint32_t number) {
  EmulatedFrame frame;
  frame.number = number;
  frame.captured = from_utime(1'700'000'000'123'456 + number);
  frame.latency_s = 0.008;
  frame.bodies.push_back({"Q1", lift({1.0, -2.0, 0.5}, 3.0), false});
  frame.bodies.push_back({"Q2", lift({4.0, 5.0, -1.0}, 6.0), true});
  frame.bodies.push_back(
      {"Q3",
       {{-7.0, 8.0, 9.0},
        Quaternion(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -2.0).normalized()))},
       false});
  return frame;
}

ServerSettings settings_of(OcclusionStyle style, bool is_y_up = false) {
  ServerSettings out;
  out.occlusion = style;
  out.is_y_up = is_y_up;
  return out;
}

// --- DataStream

struct Packet {
  std::map<std::uint32_t, std::vector<Bytes>> blocks;  ///< block contents by type
  [[nodiscard]] std::set<std::uint32_t> types() const {
    std::set<std::uint32_t> out;
    for (const auto& [type, bodies] : blocks) {
      out.insert(type);
    }
    return out;
  }
  template <class Value>
  [[nodiscard]] Value get(std::uint32_t type, std::size_t which = 0) const {
    Value out;
    EXPECT_TRUE(blocks.contains(type) && which < blocks.at(type).size() &&
                decode(blocks.at(type)[which], out))
        << type;
    return out;
  }
};

std::vector<Packet> take_packets(Peer& peer) {
  std::vector<Packet> out;
  wire::Bytes left(peer.outgoing);
  while (!left.empty()) {
    const wire::Framed framed = wire::next_packet(left);
    EXPECT_EQ(framed.state, wire::Framing::kWhole);
    wire::BlockCursor cursor(framed.body);
    out.emplace_back();
    while (const auto block = cursor.next()) {
      out.back().blocks[block->type].emplace_back(block->body.begin(), block->body.end());
    }
    left = left.subspan(framed.bytes);
  }
  peer.outgoing.clear();
  return out;
}

template <class... Blocks>
Bytes packet_of(const Blocks&... blocks) {
  Bytes out;
  wire::PacketWriter packet(out);
  (append(packet, blocks), ...);
  packet.finish();
  return out;
}

const std::vector<std::uint32_t> kAll{
    wire::kStreamInfo,      wire::kSubjectInfo,   wire::kFrameInfo,     wire::kLocalSegments,
    wire::kGlobalSegments,  wire::kLatencyInfo,   wire::kSubjectHealth, wire::kHardwareFrameInfo,
    wire::kApplicationInfo, wire::kFrameRateInfo, wire::kObjectQuality, wire::kLightweightSegments,
    wire::kContents};

/// Requests these block types from `peer`, by default as a stream.
DataStreamPeer& asking(DataStreamPeer& peer, const std::vector<std::uint32_t>& types,
                       bool is_streaming = true) {
  peer.outgoing.clear();
  EXPECT_TRUE(peer.receive(packet_of(wire::ObjectEnums{types})));
  if (is_streaming) {
    EXPECT_TRUE(peer.receive(packet_of(wire::RequestFrame{true})));
  }
  return peer;
}

TEST(DataStreamPeer, ListsItsBlocksInOrder) {
  DataStreamPeer peer{ServerSettings{}};
  const std::vector<Packet> packets = take_packets(peer);
  ASSERT_EQ(packets.size(), 1u);
  const auto offered = packets[0].get<wire::ObjectEnums>(wire::kObjectEnums);
  EXPECT_EQ(offered.types, kAll);
}

TEST(DataStreamPeer, SendsNamePoseAndLatencyOfEachBody) {
  for (const bool is_y_up : {false, true}) {
    ServerSettings settings = settings_of(OcclusionStyle::kRepeated, is_y_up);
    settings.rate_hz = 125.0;
    DataStreamPeer peer(settings);
    const EmulatedFrame frame = frame_of(77);
    asking(peer, kAll).on_frame(frame);
    const std::vector<Packet> packets = take_packets(peer);
    ASSERT_EQ(packets.size(), 1u);
    const Packet& packet = packets[0];
    EXPECT_EQ(packet.get<wire::FrameInfo>(wire::kFrameInfo).frame_number, 77U);
    EXPECT_EQ(packet.get<wire::HardwareFrameInfo>(wire::kHardwareFrameInfo).frame_number, 77U);
    EXPECT_NEAR(packet.get<wire::LatencyInfo>(wire::kLatencyInfo).total_s(), 0.008, 1e-12);
    ASSERT_EQ(packet.get<wire::LatencyInfo>(wire::kLatencyInfo).stages.size(), 2u);
    EXPECT_NEAR(packet.get<wire::StreamInfo>(wire::kStreamInfo).rate_hz(), 125.0, 1e-9);
    EXPECT_EQ(packet.get<wire::FrameRateInfo>(wire::kFrameRateInfo).rates.at(0).rate_hz, 125.0);
    EXPECT_EQ(packet.get<wire::ApplicationInfo>(wire::kApplicationInfo).is_y_up, is_y_up);
    for (std::size_t i = 0; i < 3; ++i) {
      const EmulatedBody& body = frame.bodies[i];
      const auto id = static_cast<std::uint32_t>(i + 1);
      const auto subject = packet.get<wire::SubjectInfo>(wire::kSubjectInfo, i);
      EXPECT_EQ(subject.subject_id, id);
      EXPECT_EQ(subject.name, body.name);
      ASSERT_EQ(subject.segments.size(), 1u);
      EXPECT_EQ(subject.segments[0].parent_id, 0U);
      EXPECT_EQ(subject.segments[0].name, body.name);
      const auto health = packet.get<wire::SubjectHealth>(wire::kSubjectHealth, i);
      EXPECT_EQ(health.subject_id, id);
      EXPECT_EQ(health.marker_error, 0.0);
      EXPECT_EQ(health.health, 1.0);
      const auto quality = packet.get<wire::ObjectQuality>(wire::kObjectQuality, i);
      EXPECT_EQ(quality.subject_id, id);
      EXPECT_EQ(quality.quality, 1.0);
      const auto light = packet.get<wire::LightweightSegments>(wire::kLightweightSegments, i);
      EXPECT_EQ(light.subject_id, id);
      EXPECT_EQ(light.poses.size(), body.is_occluded ? 0u : 1u) << "for any style";
      for (const auto type : {wire::kGlobalSegments, wire::kLocalSegments}) {
        const auto segments = packet.get<wire::Segments>(type, i);
        EXPECT_EQ(segments.subject_id, id);
        ASSERT_EQ(segments.poses.size(), body.is_occluded ? 0u : 1u);
        if (body.is_occluded) {
          continue;
        }
        Pose3 pose;
        EXPECT_EQ(segments.poses[0].segment_id, subject.segments[0].id);
        EXPECT_EQ(light.poses[0].segment_id, subject.segments[0].id);
        pose.translation_m = 1e-3 * segments.poses[0].translation_mm;
        pose.rotation = Quaternion(segments.poses[0].world_from_body);
        pose = is_y_up ? wire::z_up_from_y_up(pose) : pose;
        EXPECT_LT((pose.translation_m - body.world_from_body.translation_m).norm(), 1e-9);
        EXPECT_LT(pose.rotation.angularDistance(body.world_from_body.rotation), 1e-7);
        const Eigen::Vector3d turn = light.poses[0].angle_axis_rad.cast<double>();
        const Eigen::Matrix3d R =
            Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
        EXPECT_LT((R - segments.poses[0].world_from_body).norm(), 1e-5);
        EXPECT_LT((light.poses[0].translation_mm.cast<double>() - segments.poses[0].translation_mm)
                      .norm(),
                  1e-2);
      }
    }
    EXPECT_EQ(peer.frames_sent, 1);
  }
}

// Each available block type is requested alone.
TEST(DataStreamPeer, ContentsCountMatchesBlocks) {
  DataStreamPeer peer{ServerSettings{}};
  std::vector<std::uint32_t> wanted = kAll;
  wanted.push_back(wire::kTimecode);  // kTimecode is not available
  asking(peer, wanted);
  for (int time = 0; time < 3; ++time) {
    peer.on_frame(frame_of(1));
    const Packet packet = take_packets(peer).at(0);
    const auto contents = packet.get<wire::Contents>(wire::kContents);
    std::set<std::uint32_t> sent{wire::kContents};
    for (const wire::Contents::Entry& entry : contents.sent) {
      ASSERT_TRUE(packet.blocks.contains(entry.type)) << entry.type;
      EXPECT_EQ(packet.blocks.at(entry.type).size(), entry.blocks) << entry.type;
      sent.insert(entry.type);
    }
    EXPECT_EQ(packet.types(), sent);
    const std::vector<std::uint32_t> unchanged =
        time == 0 ? std::vector<std::uint32_t>{}
                  : std::vector<std::uint32_t>{wire::kStreamInfo, wire::kSubjectInfo,
                                               wire::kSubjectHealth, wire::kApplicationInfo,
                                               wire::kObjectQuality};
    std::vector<std::uint32_t> sent_unchanged = contents.unchanged;
    std::sort(sent_unchanged.begin(), sent_unchanged.end());
    std::vector<std::uint32_t> expected = unchanged;
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(sent_unchanged, expected);
  }
}

TEST(DataStreamPeer, SendsStaticBlocksOnceAndOnChange) {
  DataStreamPeer peer{ServerSettings{}};
  asking(peer, {wire::kSubjectInfo});
  const auto names_after = [&](const EmulatedFrame& frame) {
    peer.on_frame(frame);
    const Packet packet = take_packets(peer).at(0);
    std::vector<std::string> out;
    if (packet.blocks.contains(wire::kSubjectInfo)) {
      for (std::size_t i = 0; i < packet.blocks.at(wire::kSubjectInfo).size(); ++i) {
        out.push_back(packet.get<wire::SubjectInfo>(wire::kSubjectInfo, i).name);
      }
    }
    return out;
  };
  using Names = std::vector<std::string>;
  EmulatedFrame frame = frame_of(1);
  EXPECT_EQ(names_after(frame), (Names{"Q1", "Q2", "Q3"}));
  EXPECT_EQ(names_after(frame), Names{});
  frame.bodies[1].name = "OTHER";
  EXPECT_EQ(names_after(frame), (Names{"Q1", "OTHER", "Q3"}));
  EXPECT_EQ(names_after(frame), Names{});
  frame.bodies.pop_back();
  EXPECT_EQ(names_after(frame), (Names{"Q1", "OTHER"}));
  EXPECT_EQ(names_after(frame), Names{});
  EXPECT_TRUE(peer.receive(packet_of(wire::ObjectEnums{{wire::kSubjectInfo}})));
  EXPECT_EQ(names_after(frame), (Names{"Q1", "OTHER"})) << "requested again, sent again";
  EXPECT_EQ(names_after(frame), Names{});
}

// The peer sends no frame without a request, one frame per request (at most 1000 pending), or a
// stream.
TEST(DataStreamPeer, SendsRequestedNumberOfFrames) {
  const auto sent_after = [](const std::vector<Bytes>& requests) {
    DataStreamPeer peer{ServerSettings{}};
    asking(peer, {wire::kFrameInfo}, false);
    for (const Bytes& request : requests) {
      EXPECT_TRUE(peer.receive(request));
    }
    for (std::uint32_t k = 0; k < 1'100; ++k) {
      peer.on_frame(frame_of(k));
    }
    EXPECT_EQ(take_packets(peer).size(), static_cast<std::size_t>(peer.frames_sent));
    return peer.frames_sent;
  };
  const Bytes one = packet_of(wire::RequestFrame{false});
  const Bytes all = packet_of(wire::RequestFrame{true});
  const auto next = [](std::uint32_t count) { return packet_of(wire::RequestNextFrame{count}); };
  EXPECT_EQ(sent_after({}), 0);
  EXPECT_EQ(sent_after({one}), 1);
  EXPECT_EQ(sent_after({one, one}), 1) << "a pending request is sufficient";
  EXPECT_EQ(sent_after({next(3)}), 3);
  EXPECT_EQ(sent_after({next(3), next(4)}), 7);
  EXPECT_EQ(sent_after({next(3), one}), 3);
  EXPECT_EQ(sent_after({next(999), next(2)}), 1'000);
  EXPECT_EQ(sent_after({next(0xFFFFFFFF)}), 1'000);
  EXPECT_EQ(sent_after({next(500), next(0xFFFFFFFF)}), 1'000);
  EXPECT_EQ(sent_after({all}), 1'100);
  EXPECT_EQ(sent_after({next(3), all, one}), 1) << "a sent frame is no longer pending";
}

TEST(DataStreamPeer, AnswersPingsAndSkipsFramesWhileItsBacklogIsFull) {
  ServerSettings settings;
  settings.backlog_bytes_max = 200;
  DataStreamPeer peer(settings);
  asking(peer, {wire::kFrameInfo});
  EXPECT_TRUE(peer.receive(packet_of(wire::Ping{0x1122334455667788ULL})));
  const Packet pong = take_packets(peer).at(0);
  EXPECT_EQ(pong.get<wire::Ping>(wire::kPing).id, 0x1122334455667788ULL);
  peer.outgoing.assign(200, 0);
  EXPECT_TRUE(peer.receive(packet_of(wire::Ping{1})));
  EXPECT_EQ(peer.outgoing.size(), 200u);
  peer.on_frame(frame_of(1));
  EXPECT_GT(peer.outgoing.size(), 200u) << "up to its limit";
  EXPECT_EQ(peer.frames_skipped, 0);
  peer.outgoing.assign(201, 0);
  peer.on_frame(frame_of(2));
  peer.on_frame(frame_of(3));
  EXPECT_EQ(peer.outgoing.size(), 201u);
  EXPECT_EQ(peer.frames_skipped, 2);
  EXPECT_EQ(peer.frames_sent, 1);
  peer.outgoing.clear();
  peer.on_frame(frame_of(4));
  EXPECT_EQ(take_packets(peer).size(), 1u);
  EXPECT_EQ(peer.frames_sent, 2);
}

TEST(DataStreamPeer, ReassemblesPacketsAndClosesOnInvalidOnes) {
  const Bytes request_bytes =
      packet_of(wire::ObjectEnums{{wire::kFrameInfo}}, wire::RequestFrame{true});
  {
    DataStreamPeer peer{ServerSettings{}};
    peer.outgoing.clear();
    for (std::size_t k = 0; k < request_bytes.size(); ++k) {
      peer.on_frame(frame_of(1));
      EXPECT_TRUE(peer.outgoing.empty()) << "not requested yet";
      EXPECT_TRUE(peer.receive(wire::Bytes(request_bytes).subspan(k, 1)));
    }
    peer.on_frame(frame_of(2));
    EXPECT_EQ(take_packets(peer).size(), 1u);
  }
  DataStreamPeer foreign{ServerSettings{}};
  EXPECT_FALSE(foreign.receive(Bytes{'G', 'E', 'T', ' ', '/', '\r', '\n', '\r', '\n'}));
  DataStreamPeer broken{ServerSettings{}};
  Bytes torn = request_bytes;
  torn[12] = 0xFF;  // a block that is longer than its packet
  EXPECT_FALSE(broken.receive(torn));
  // An unfinished packet with a stated length that exceeds the limit for clients.
  DataStreamPeer endless{ServerSettings{}};
  Bytes long_packet = request_bytes;
  long_packet[6] = 0x02;
  EXPECT_TRUE(endless.receive(long_packet));
  EXPECT_TRUE(endless.receive(Bytes((1U << 16U) - long_packet.size(), 0)));
  EXPECT_FALSE(endless.receive(Bytes(1, 0)));
}

// --- object stream

TEST(ObjectStreamServer, SendsBodiesInOrderInSeveralDatagrams) {
  for (const std::size_t bytes : {256U, 512U, 1024U}) {
    const std::size_t fit = wire::objects_per_block(bytes);
    ServerSettings settings;
    settings.block_bytes = bytes;
    ObjectStreamServer server(settings);
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, fit, fit + 1, 2 * fit, 3 * fit - 1, std::size_t{2}}) {
      EmulatedFrame frame;
      frame.number = 4'000'000'000U + static_cast<std::uint32_t>(count);
      for (std::size_t i = 0; i < count; ++i) {
        const auto x_m = static_cast<double>(i);
        frame.bodies.push_back({"B" + std::to_string(i), lift({x_m, -2.0 * x_m, 0.1}, 3.0)});
      }
      const auto& datagrams = server.encode(frame);
      EXPECT_EQ(datagrams.size(), count <= fit ? 1u : count <= 2 * fit ? 2u : 3u);
      std::size_t i = 0;
      for (const auto& datagram : datagrams) {
        EXPECT_EQ(datagram.size(), bytes);
        wire::ObjectBlock block;
        ASSERT_TRUE(wire::decode_object_block(datagram, block));
        EXPECT_EQ(block.frame_number, frame.number);
        for (const wire::TrackerObject& object : block.objects) {
          EXPECT_EQ(object.name(), "B" + std::to_string(i));
          const auto x_m = static_cast<double>(i);
          EXPECT_EQ(object.translation_mm, Eigen::Vector3d(1e3 * x_m, -2e3 * x_m, 3e3));
          ++i;
        }
      }
      EXPECT_EQ(i, count);
    }
  }
}

/// Returns the objects of a frame by name.
std::map<std::string, wire::TrackerObject> objects_of(ObjectStreamServer& server,
                                                      const EmulatedFrame& frame) {
  std::map<std::string, wire::TrackerObject> out;
  for (const auto& datagram : server.encode(frame)) {
    wire::ObjectBlock block;
    EXPECT_TRUE(wire::decode_object_block(datagram, block));
    for (const wire::TrackerObject& object : block.objects) {
      out[std::string(object.name())] = object;
    }
  }
  return out;
}

TEST(ObjectStreamServer, SendsVisibleAndHiddenBodies) {
  for (const bool is_y_up : {false, true}) {
    ObjectStreamServer server(settings_of(OcclusionStyle::kAbsent, is_y_up));
    const EmulatedFrame frame = frame_of(1);
    const auto objects = objects_of(server, frame);
    EXPECT_EQ(objects.size(), 2u);
    for (const std::size_t i : {0U, 2U}) {
      const wire::TrackerObject& object = objects.at(frame.bodies[i].name);
      Pose3 pose{1e-3 * object.translation_mm, wire::rotation_from_euler_xyz(object.euler_xyz_rad)};
      pose = is_y_up ? wire::z_up_from_y_up(pose) : pose;
      EXPECT_LT((pose.translation_m - frame.bodies[i].world_from_body.translation_m).norm(), 1e-9);
      EXPECT_LT(pose.rotation.angularDistance(frame.bodies[i].world_from_body.rotation), 1e-7);
    }
  }
  EmulatedFrame seen = frame_of(1);
  seen.bodies[1].is_occluded = false;
  ObjectStreamServer zero(settings_of(OcclusionStyle::kZero));
  objects_of(zero, seen);
  EXPECT_EQ(objects_of(zero, frame_of(2)).at("Q2").translation_mm, Eigen::Vector3d::Zero());
  EXPECT_EQ(objects_of(zero, frame_of(2)).at("Q2").euler_xyz_rad, Eigen::Vector3d::Zero());
  ObjectStreamServer repeated(settings_of(OcclusionStyle::kRepeated));
  EXPECT_EQ(objects_of(repeated, frame_of(0)).at("Q2").translation_mm, Eigen::Vector3d::Zero())
      << "no pose was seen yet";
  const auto before = objects_of(repeated, seen);
  for (std::uint32_t k = 2; k < 5; ++k) {
    EmulatedFrame frame = frame_of(k);
    frame.bodies[1].world_from_body.translation_m.x() += k;
    EXPECT_EQ(objects_of(repeated, frame).at("Q2").translation_mm, Eigen::Vector3d(4e3, 5e3, 6e3));
    EXPECT_EQ(objects_of(repeated, frame).at("Q2").euler_xyz_rad, before.at("Q2").euler_xyz_rad);
  }
  seen.bodies[1].world_from_body.translation_m.x() = 1.0;
  objects_of(repeated, seen);
  EXPECT_EQ(objects_of(repeated, frame_of(9)).at("Q2").translation_mm,
            Eigen::Vector3d(1e3, 5e3, 6e3))
      << "the last pose, not the first";
}

}  // namespace
}  // namespace vantage::sim::vicon
