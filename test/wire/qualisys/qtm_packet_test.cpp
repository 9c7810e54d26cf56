#include <gtest/gtest.h>

#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/qualisys/packet.hpp"

// Bytes from the public clients of the protocol: header u32 size (with the header), u32 type.

namespace vantage::wire::qualisys {
namespace {

using test::from_hex;
using vicon::Framing;
using Buffer = std::vector<std::uint8_t>;

TEST(QtmPacket, HasThePublishedBytes) {
  Buffer bytes;
  append_text(bytes, PacketType::kCommand, "Version 1.25");
  EXPECT_EQ(bytes, from_hex("15000000 01000000 56657273696f6e20312e323500"));
  const Packet packet = next_packet(bytes);
  EXPECT_EQ(packet.state, Framing::kWhole);
  EXPECT_EQ(packet.type, PacketType::kCommand);
  EXPECT_EQ(packet.bytes, bytes.size());
  EXPECT_EQ(text_of(packet.body), "Version 1.25");
  EXPECT_EQ(text_of(from_hex("4142")), "AB") << "without NUL";
  bytes.clear();
  append_event(bytes, 10);
  append_no_more_data(bytes);
  EXPECT_EQ(bytes, from_hex("09000000 06000000 0a 08000000 04000000"));
}

TEST(QtmPacket, WaitsForTheWholePacket) {
  Buffer bytes;
  append_text(bytes, PacketType::kXml, "<a/>");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(next_packet(Bytes(bytes).first(size)).state, Framing::kNeedMore) << size;
  }
  EXPECT_EQ(next_packet(from_hex("07000000 01000000")).state, Framing::kBroken)
      << "smaller than its header";
  EXPECT_EQ(next_packet(from_hex("01001000 01000000")).state, Framing::kBroken) << "too large";
  EXPECT_EQ(next_packet(from_hex("00001000 01000000")).state, Framing::kNeedMore) << "the largest";
  EXPECT_EQ(next_packet(from_hex("00000015 00000001")).state, Framing::kBroken) << "big-endian";
}

/// Returns the body of a data packet: time 1 000 001 µs, frame 7, one component.
Buffer data_hex(const std::string& component) {
  return from_hex("41420f0000000000 07000000 01000000" + component);
}

// A turn by 90° about z: the first column of the matrix, the image of x, is y.
const std::string kMatrixHex =
    "00000000 0000803f 00000000  000080bf 00000000 00000000  00000000 00000000 0000803f";
const std::string kPositionHex = "0000803f 00000040 00004040";  // 1, 2, 3 mm

TEST(QtmFrame, ReadsTheReferenceBytesOfEachComponent) {
  struct Row {
    Component component;
    std::string hex;
    bool has_matrix, has_residual;
  };
  const std::string euler_hex = "00000000 00000000 0000b442";  // 0, 0, 90°
  for (const Row& row :
       {Row{Component::k6D, "40000000 05000000 01000000 0200 0300" + kPositionHex + kMatrixHex,
            true, false},
        Row{Component::k6DEuler, "28000000 06000000 01000000 0200 0300" + kPositionHex + euler_hex,
            false, false},
        Row{Component::k6DResidual,
            "44000000 0b000000 01000000 0200 0300" + kPositionHex + kMatrixHex + "0000003f", true,
            true},
        Row{Component::k6DEulerResidual,
            "2c000000 0c000000 01000000 0200 0300" + kPositionHex + euler_hex + "0000003f", false,
            true}}) {
    const Buffer body = data_hex(row.hex);
    Frame frame;
    ASSERT_TRUE(decode_frame(body, frame)) << static_cast<int>(row.component);
    EXPECT_EQ(frame.time_us, 1'000'001);
    EXPECT_EQ(frame.number, 7u);
    EXPECT_EQ(frame.component, row.component);
    EXPECT_EQ(frame.drop_rate, 2);
    EXPECT_EQ(frame.out_of_sync_rate, 3);
    ASSERT_EQ(frame.bodies.size(), 1u);
    EXPECT_EQ(frame.bodies[0].position_mm, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
    const Eigen::Vector3f x_in_world = frame.bodies[0].world_from_body * Eigen::Vector3f::UnitX();
    EXPECT_EQ(x_in_world, row.has_matrix ? Eigen::Vector3f(0, 1, 0) : Eigen::Vector3f(1, 0, 0));
    EXPECT_EQ(frame.bodies[0].euler_deg.z(), row.has_matrix ? 0.0F : 90.0F);
    EXPECT_EQ(frame.bodies[0].residual_mm, row.has_residual ? 0.5F : 0.0F);
    Buffer written;
    append_frame(written, frame);
    EXPECT_EQ(Buffer(written.begin() + kHeaderBytes, written.end()), body);
    for (std::size_t size = 0; size < body.size(); ++size) {
      EXPECT_FALSE(decode_frame(Bytes(body).first(size), frame)) << size;
    }
  }
}

TEST(QtmFrame, SkipsOtherComponents) {
  Frame frame;
  const std::string poses = "10000000 0b000000 00000000 0000 0000";
  EXPECT_TRUE(decode_frame(
      from_hex("0000000000000000 07000000 02000000 0c000000 01000000 aabbccdd" + poses), frame));
  EXPECT_TRUE(frame.bodies.empty());
  EXPECT_FALSE(decode_frame(data_hex("0c000000 01000000 aabbccdd"), frame)) << "no poses";
  EXPECT_FALSE(decode_frame(data_hex("07000000 01000000"), frame)) << "smaller than its header";
}

TEST(QtmFrame, RefusesCountsThatContradictTheSize) {
  Frame frame;
  for (const char* count : {"00000000", "02000000", "ffffffff", "00000080"}) {
    EXPECT_FALSE(decode_frame(data_hex(std::string("44000000 0b000000") + count + "0000 0000" +
                                       kPositionHex + kMatrixHex + "0000003f"),
                              frame))
        << count;
  }
}

}  // namespace
}  // namespace vantage::wire::qualisys
