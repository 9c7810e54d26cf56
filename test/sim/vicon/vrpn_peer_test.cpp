#include "sim/vicon/vrpn_peer.hpp"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

namespace wire = vantage::wire::vicon;
using Bytes = std::vector<std::uint8_t>;

struct Message {
  wire::VrpnHeader header;
  Bytes body;
};

/// Returns the messages that the peer has sent since the last call, without the cookie.
std::vector<Message> take_messages(VrpnPeer& peer, bool has_cookie = false) {
  std::vector<Message> out;
  wire::Bytes left(peer.outgoing);
  left = left.subspan(has_cookie ? wire::kVrpnCookieBytes : 0);
  while (!left.empty()) {
    Message message;
    const wire::Framed framed = wire::next_vrpn_message(left, message.header);
    EXPECT_EQ(framed.state, wire::Framing::kWhole);
    message.body.assign(framed.body.begin(), framed.body.end());
    out.push_back(message);
    left = left.subspan(framed.bytes);
  }
  peer.outgoing.clear();
  return out;
}

Bytes cookie() {
  Bytes out;
  wire::append_vrpn_cookie(out);
  return out;
}

EmulatedFrame frame_of(double x_m) {
  EmulatedFrame frame;
  frame.captured = from_utime(1'700'000'000'123'456);
  frame.bodies.push_back({"Q1", lift({x_m, -2.0, 0.5}, 3.0), false});
  frame.bodies.push_back({"Q2", lift({x_m + 4.0, 5.0, -1.0}, 6.0), true});
  return frame;
}

/// A client after the handshake. It knows the ids that the peer uses for senders and types.
struct VrpnClient {
  explicit VrpnClient(OcclusionStyle style, bool is_y_up = false, std::size_t backlog = 1U << 20U)
      : peer(settings_of(style, is_y_up, backlog)) {
    EXPECT_TRUE(peer.receive(cookie()));
    receive_poses(true);
  }
  static ServerSettings settings_of(OcclusionStyle style, bool is_y_up, std::size_t backlog) {
    ServerSettings out;
    out.occlusion = style;
    out.is_y_up = is_y_up;
    out.backlog_bytes_max = backlog;
    return out;
  }
  /// Stores the names that the peer defines; returns the poses by sender and type name.
  std::map<std::string, wire::VrpnPose> receive_poses(bool has_cookie = false) {
    std::map<std::string, wire::VrpnPose> poses;
    for (const Message& message : take_messages(peer, has_cookie)) {
      const std::int32_t id = message.header.sender;
      if (message.header.type == wire::kVrpnSenderDescription) {
        senders[id] = wire::decode_vrpn_name(message.body).value_or("");
        ++announced;
      } else if (message.header.type == wire::kVrpnTypeDescription) {
        types[id] = wire::decode_vrpn_name(message.body).value_or("");
      } else if (types[message.header.type] == wire::kVrpnPoseType) {
        last = message.header;
        const auto pose = wire::decode_vrpn_pose(message.body);
        EXPECT_TRUE(pose);
        poses[senders.at(id)] = pose.value_or(wire::VrpnPose{});
      } else if (types[message.header.type] == wire::kVrpnPongType) {
        pongs.push_back(senders.at(id));
      } else {
        ADD_FAILURE() << "type " << message.header.type;
      }
    }
    return poses;
  }
  std::map<std::string, wire::VrpnPose> show(const EmulatedFrame& frame) {
    peer.on_frame(frame);
    return receive_poses();
  }
  void name(std::int32_t type, std::int32_t id, std::string_view name) {
    Bytes out;
    wire::append_vrpn_name(out, type, id, name);
    EXPECT_TRUE(peer.receive(out));
  }
  void request(std::int32_t sender, std::int32_t type) {
    Bytes out;
    wire::append_vrpn_message(out, {0, 0, sender, type}, {});
    EXPECT_TRUE(peer.receive(out));
    receive_poses();
  }
  VrpnPeer peer;
  std::map<std::int32_t, std::string> senders;
  std::map<std::int32_t, std::string> types;
  std::vector<std::string> pongs;
  int announced = 0;
  wire::VrpnHeader last;
};

TEST(VrpnPeer, SendsItsCookieFirst) {
  VrpnPeer peer{ServerSettings{}};
  EXPECT_EQ(peer.outgoing, cookie());
  peer.outgoing.clear();
  const Bytes greeting = cookie();
  for (std::size_t k = 0; k < greeting.size(); ++k) {
    peer.on_frame(frame_of(1.0));
    EXPECT_TRUE(peer.outgoing.empty());
    EXPECT_TRUE(peer.receive(wire::Bytes(greeting).subspan(k, 1)));
  }
  EXPECT_EQ(peer.frames_sent, 0);
  EXPECT_EQ(take_messages(peer).size(), 2u) << "two types";
  peer.on_frame(frame_of(1.0));
  EXPECT_EQ(peer.frames_sent, 1);
}

TEST(VrpnPeer, ClosesOnAnInvalidCookieOrMessage) {
  const auto is_taken = [](const std::string& text) {
    VrpnPeer peer{ServerSettings{}};
    Bytes bytes(text.begin(), text.end());
    bytes.resize(wire::kVrpnCookieBytes, 0);
    return peer.receive(bytes);
  };
  EXPECT_TRUE(is_taken("vrpn: ver. 07.35  0"));
  EXPECT_TRUE(is_taken("vrpn: ver. 07.01  0"));
  EXPECT_FALSE(is_taken("vrpn: ver. 06.35  0"));
  EXPECT_FALSE(is_taken("vrpn: ver. 08.35  0"));
  EXPECT_FALSE(is_taken("GET / HTTP/1.1"));
  VrpnPeer peer{ServerSettings{}};
  EXPECT_TRUE(peer.receive(cookie()));
  EXPECT_FALSE(peer.receive(Bytes(24, 0xFF)));
}

TEST(VrpnPeer, SendsEachBodyWithTheCaptureTime) {
  for (const bool is_y_up : {false, true}) {
    VrpnClient client(OcclusionStyle::kAbsent, is_y_up);
    EmulatedFrame frame = frame_of(1.0);
    frame.bodies[1].is_occluded = false;
    const auto poses = client.show(frame);
    EXPECT_EQ(client.announced, 2);
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_EQ(client.last.seconds, 1'700'000'000U);
    EXPECT_EQ(client.last.microseconds, 123'456U);
    for (const EmulatedBody& body : frame.bodies) {
      const wire::VrpnPose& sent = poses.at(body.name);
      EXPECT_EQ(sent.sensor, 0);
      Pose3 pose{sent.position_m, Quaternion(sent.quaternion_xyzw(3), sent.quaternion_xyzw(0),
                                             sent.quaternion_xyzw(1), sent.quaternion_xyzw(2))};
      pose = is_y_up ? wire::z_up_from_y_up(pose) : pose;
      EXPECT_LT((pose.translation_m - body.world_from_body.translation_m).norm(), 1e-12);
      EXPECT_LT(pose.rotation.angularDistance(body.world_from_body.rotation), 1e-7);
    }
    client.show(frame);
    EXPECT_EQ(client.announced, 2) << "names are announced once";
    frame.bodies.push_back({"LATE", lift({}, 0.0), false});
    EXPECT_EQ(client.show(frame).size(), 3u);
    EXPECT_EQ(client.announced, 3);
    EXPECT_EQ(client.senders.size(), 3u) << "one number per sender";
  }
}

TEST(VrpnPeer, SendsOccludedBodiesInTheConfiguredStyle) {
  EmulatedFrame seen = frame_of(1.0);
  seen.bodies[1].is_occluded = false;
  VrpnClient absent(OcclusionStyle::kAbsent);
  absent.show(seen);
  EXPECT_EQ(absent.show(frame_of(2.0)).count("Q2"), 0u);
  VrpnClient zero(OcclusionStyle::kZero);
  zero.show(seen);
  EXPECT_EQ(zero.show(frame_of(2.0)).at("Q2").position_m, Eigen::Vector3d::Zero());
  EXPECT_EQ(zero.show(frame_of(2.0)).at("Q1").position_m, Eigen::Vector3d(2.0, -2.0, 3.0));
  VrpnClient repeated(OcclusionStyle::kRepeated);
  EXPECT_EQ(repeated.show(frame_of(0.0)).at("Q2").position_m, Eigen::Vector3d::Zero());
  repeated.show(seen);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(repeated.show(frame_of(2.0 + k)).at("Q2").position_m, Eigen::Vector3d(5.0, 5.0, 6.0));
  }
}

// A ping to a named body is answered by that body. The ids in the ping are those of the client.
TEST(VrpnPeer, AnswersPingsOfKnownBodies) {
  VrpnClient client(OcclusionStyle::kAbsent);
  client.show(frame_of(1.0));
  client.name(wire::kVrpnSenderDescription, 5, "Q2");
  client.name(wire::kVrpnSenderDescription, 6, "Q1");
  client.name(wire::kVrpnSenderDescription, 7, "NOBODY");
  client.name(wire::kVrpnTypeDescription, 8, wire::kVrpnPingType);
  client.name(wire::kVrpnTypeDescription, 9, wire::kVrpnPongType);
  client.request(5, 8);
  EXPECT_EQ(client.pongs, std::vector<std::string>{"Q2"});
  client.request(6, 8);
  EXPECT_EQ(client.pongs, (std::vector<std::string>{"Q2", "Q1"}));
  client.request(7, 8);  // id of an unknown body
  client.request(5, 9);  // a type other than ping
  client.request(5, 4);  // a type that has not been named
  client.request(4, 8);  // a sender that has not been named
  EXPECT_EQ(client.pongs.size(), 2u);
  client.name(wire::kVrpnSenderDescription, 5, "Q1");
  client.request(5, 8);
  EXPECT_EQ(client.pongs.back(), "Q1") << "the new name";
}

TEST(VrpnPeer, LimitsAClientToAThousandNames) {
  VrpnClient client(OcclusionStyle::kAbsent);
  client.show(frame_of(1.0));
  client.name(wire::kVrpnTypeDescription, 1, wire::kVrpnPingType);
  for (int i = 0; i < 1023; ++i) {
    client.name(wire::kVrpnSenderDescription, i, "X");
  }
  client.name(wire::kVrpnSenderDescription, 2000, "Q1");
  client.name(wire::kVrpnSenderDescription, 2001, "Q2");
  client.request(2000, 1);
  EXPECT_EQ(client.pongs, std::vector<std::string>{"Q1"}) << "1024";
  client.request(2001, 1);
  EXPECT_EQ(client.pongs.size(), 1u);
}

TEST(VrpnPeer, SkipsFramesAndPingsWhileItsBacklogIsFull) {
  VrpnClient client(OcclusionStyle::kAbsent, false, 200);
  client.show(frame_of(1.0));
  client.name(wire::kVrpnSenderDescription, 5, "Q2");
  client.name(wire::kVrpnTypeDescription, 8, wire::kVrpnPingType);
  Bytes ping;
  wire::append_vrpn_message(ping, {0, 0, 5, 8}, {});
  client.peer.outgoing.assign(201, 0);
  client.peer.on_frame(frame_of(2.0));
  EXPECT_TRUE(client.peer.receive(ping));
  EXPECT_EQ(client.peer.outgoing.size(), 201u);
  EXPECT_EQ(client.peer.frames_skipped, 1);
  EXPECT_EQ(client.peer.frames_sent, 1);
  client.peer.outgoing.assign(200, 0);
  EXPECT_TRUE(client.peer.receive(ping));
  EXPECT_GT(client.peer.outgoing.size(), 200u) << "up to its limit";
  client.peer.outgoing.assign(200, 0);
  client.peer.on_frame(frame_of(3.0));
  EXPECT_GT(client.peer.outgoing.size(), 200u);
  EXPECT_EQ(client.peer.frames_sent, 2);
}

}  // namespace
}  // namespace vantage::sim::vicon
