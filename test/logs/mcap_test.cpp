// Our MCAP files are read by @mcap/core, which shares no code with our writer.

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "logs/export/crc32.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/export/mcap_writer.hpp"
#include "logs/record/log_writer.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

const std::string kPeer = std::string(VANTAGE_SOURCE_DIR) + "/test/logs/mcap_peer";

TEST(Crc32, MatchesTheStandardsCheckValue) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc32("6789", crc32("12345")), 0xCBF43926U);
}

TEST(McapWriter, RefusesAnUnwritablePath) {
  EXPECT_THROW(McapWriter("/nonexistent/folder/x.mcap"), StartupError);
}

class McapPeer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kPeer + "/node_modules/@mcap/core")) {
      GTEST_SKIP() << "@mcap/core is not installed: tools/setup";
    }
  }
  /// Returns what the peer prints for `path`; "" if it refuses the file.
  std::string read(const std::string& path) const {
    const std::string out = folder_.file("out");
    const std::string command = "node " + kPeer + "/peer.mjs " + path + " > " + out;
    if (std::system(command.c_str()) != 0) {
      return "";
    }
    const test::Bytes bytes = test::read_file(out);
    return {bytes.begin(), bytes.end()};
  }
  test::TemporaryFolder folder_;
};

TEST_F(McapPeer, ReadsMessagesOfSeveralChunksInTimeOrder) {
  const std::string path = folder_.file("a.mcap");
  const std::string schema = R"({"type":"object","properties":{"i":{"type":"integer"}}})";
  constexpr int kMessages = 40'000;
  std::ostringstream expected;
  {
    McapWriter writer(path);
    const auto even = writer.topic("/even", "vantage.Number", schema);
    const auto odd = writer.topic("/odd", "vantage.Number", schema);
    EXPECT_EQ(writer.topic("/even", "vantage.Number", schema), even);
    expected << "summary /even vantage.Number " << kMessages / 2 << "\n"
             << "summary /odd vantage.Number " << kMessages / 2 << "\n";
    for (int i = 0; i < kMessages; ++i) {
      const Time time = from_utime(1'700'000'000'000'000 + 1'000 * i);
      const std::string json = "{\"i\":" + std::to_string(i) + "}";
      writer.write(i % 2 == 0 ? even : odd, time, time, json);
      expected << "message " << (i % 2 == 0 ? "/even " : "/odd ") << to_utime(time) << "000 "
               << json << "\n";
    }
    EXPECT_EQ(writer.messages(), static_cast<std::uint64_t>(kMessages));
    EXPECT_TRUE(writer.finish());
  }
  EXPECT_LT(std::filesystem::file_size(path), 1U << 20U) << "from 3.3 MB";
  EXPECT_TRUE(read(path) == expected.str());
}

TEST_F(McapPeer, ReadsAFileWithoutMessages) {
  const std::string path = folder_.file("empty.mcap");
  { const McapWriter writer(path); }
  EXPECT_EQ(read(path), "\n");
}

TEST_F(McapPeer, DetectsADamagedFile) {
  const std::string path = folder_.file("bad.mcap");
  {
    McapWriter writer(path);
    const auto topic = writer.topic("/a", "A", R"({"type":"object","properties":{"i":{}}})");
    writer.write(topic, from_utime(1), from_utime(1), R"({"i":12345})");
  }
  test::Bytes bytes = test::read_file(path);
  ASSERT_NE(read(path), "");
  bytes[60] ^= 1U;
  test::write_file(path, bytes);
  EXPECT_EQ(read(path), "");
}

TEST_F(McapPeer, ReadsAnExportedLogOfEveryType) {
  const std::string log_path = folder_.file("a.lcmlog");
  constexpr int kOfEach = 20;
  {
    LogWriter log(log_path);
    vantage::test::Sampler sampler(9);
    std::int64_t utime = 1'700'000'000'000'000;
    const auto add = [&]<class Message>(const std::string& channel) {
      for (int i = 0; i < kOfEach; ++i) {
        log.write(from_utime(utime += 1'000), channel,
                  vantage::test::encoded(vantage::test::sample<Message>(sampler)));
      }
    };
    add.template operator()<models::MocapFrame>("VICON");
    add.template operator()<models::RobotMeasurement>("MEASUREMENT_Q1");
    add.template operator()<models::RobotBelief>("BELIEF_Q1");
    add.template operator()<models::RobotPlan>("PLAN_Q1");
    add.template operator()<models::VehicleStatus>("VEHICLE_Q1");
    add.template operator()<models::OperatorCommand>("COMMAND");
    add.template operator()<models::TruthFrame>("TRUTH");
    add.template operator()<models::CollisionReport>("COLLISION");
    add.template operator()<models::AttackNotice>("ATTACK");
    add.template operator()<models::ProcessHealth>("HEALTH_SIM");
    add.template operator()<models::HostReport>("HOST_LAB");
    add.template operator()<models::ScenarioNotice>("SCENARIO");
    log.write(from_utime(utime), "FOREIGN", test::Bytes{1, 2, 3});
  }
  const IndexedLog log(log_path);
  ChannelFilter all;
  const ExportCounts counts = export_mcap(log, folder_.file("a.mcap"), all, true);
  EXPECT_EQ(counts.failure, "");
  EXPECT_EQ(counts.left_out, (std::map<std::string, std::int64_t>{{"FOREIGN", 1}}));
  const std::string listing = read(folder_.file("a.mcap"));
  for (const char* line :
       {"summary VICON vantage_lcm.mocap_frame_t 20\n", "summary PLAN_Q1 vantage_lcm.plan_t 20\n",
        "summary SCENARIO vantage_lcm.scenario_t 20\n"}) {
    EXPECT_NE(listing.find(line), std::string::npos) << line;
  }
  EXPECT_GE(counts.messages, 12U * kOfEach);
}

// LCM allows any bytes in a channel name, but MCAP requires UTF-8: a reader refuses the whole file
// because of one invalid name.
TEST_F(McapPeer, ReadsALogWithNamesThatAreNotUtf8) {
  const std::string log_path = folder_.file("a.lcmlog");
  {
    LogWriter log(log_path);
    vantage::test::Sampler sampler(9);
    const auto data = vantage::test::encoded(vantage::test::sample<models::AttackNotice>(sampler));
    log.write(from_utime(1'700'000'000'000'000),
              "ATT\xC4"
              "CK",
              data);
    log.write(from_utime(1'700'000'000'000'001), "A\tB", data);
    log.write(from_utime(1'700'000'000'000'002), "FOREIGN\xFF", test::Bytes{1, 2, 3});
  }
  const IndexedLog log(log_path);
  EXPECT_TRUE(log.survey().is_whole());
  ChannelFilter all;
  const ExportCounts counts = export_mcap(log, folder_.file("a.mcap"), all, false);
  EXPECT_EQ(counts.messages, 2U);
  EXPECT_EQ(counts.left_out, (std::map<std::string, std::int64_t>{{"FOREIGN\xFF", 1}}));
  const std::string listing = read(folder_.file("a.mcap"));
  EXPECT_NE(listing.find("summary ATT\\xC4CK vantage_lcm.attack_t 1\n"), std::string::npos)
      << listing;
  EXPECT_NE(listing.find("summary A\\x09B vantage_lcm.attack_t 1\n"), std::string::npos) << listing;
}

TEST(ExportMcap, WritesACompleteFileWhenStoppedOnRequest) {
  test::TemporaryFolder folder;
  {
    LogWriter log(folder.file("a.lcmlog"));
    vantage::test::Sampler sampler(9);
    for (int i = 0; i < 5; ++i) {
      log.write(from_utime(i), "ATTACK",
                vantage::test::encoded(vantage::test::sample<models::AttackNotice>(sampler)));
    }
  }
  const IndexedLog log(folder.file("a.lcmlog"));
  ChannelFilter all;
  int checks = 0;
  const ExportCounts counts =
      export_mcap(log, folder.file("a.mcap"), all, false, {}, [&] { return ++checks > 3; });
  EXPECT_TRUE(counts.is_stopped);
  EXPECT_EQ(counts.messages, 3U);
  const test::Bytes bytes = test::read_file(folder.file("a.mcap"));
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + 8, bytes.end() - 8)) << "magic bytes";
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.mcap.part")));
}

TEST(McapWriter, ReportsAFullDiskAndRemovesThePartialFile) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.mcap");
  std::filesystem::create_symlink("/dev/full", path + ".part");
  McapWriter writer(path);
  const auto topic = writer.topic("/a", "A", R"({"type":"object"})");
  writer.write(topic, from_utime(1), from_utime(1), std::string(1'000, 'x'));
  EXPECT_FALSE(writer.finish());
  EXPECT_EQ(writer.failure(), path + ": cannot be written: No space left on device");
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::is_symlink(path + ".part"));
}

std::uint64_t number_at(const test::Bytes& bytes, std::size_t at) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    out |= std::uint64_t{bytes.at(at + i)} << (8 * i);
  }
  return out;
}

// Reads the file by the specification only: opcode, length, content. A chunk and its index begin
// with the times of the first and last message.
TEST(McapWriter, WritesTheTimeSpanOfEachChunk) {
  constexpr std::uint8_t kChunk = 0x06;
  constexpr std::uint8_t kChunkIndex = 0x08;
  constexpr std::size_t kMagicBytes = 8;
  test::TemporaryFolder folder;
  const std::string path = folder.file("spans.mcap");
  constexpr int kMessages = 4'000;
  const auto time_us = [](int i) { return 1'700'000'000'000'000 + 1'000 * i; };
  {
    McapWriter writer(path);
    const auto topic = writer.topic("/a", "A", R"({"type":"object"})");
    const std::string json = "{\"text\":\"" + std::string(1'000, 'x') + "\"}";
    for (int i = 0; i < kMessages; ++i) {
      writer.write(topic, from_utime(time_us(i)), from_utime(time_us(i)), json);
    }
  }
  const test::Bytes bytes = test::read_file(path);
  using Span = std::pair<std::uint64_t, std::uint64_t>;
  std::vector<Span> chunks;
  std::vector<Span> indexed;
  for (std::size_t at = kMagicBytes; at + 9 + kMagicBytes <= bytes.size();
       at += 9 + number_at(bytes, at + 1)) {
    const Span span{number_at(bytes, at + 9), number_at(bytes, at + 17)};
    if (bytes[at] == kChunk) {
      chunks.push_back(span);
    } else if (bytes[at] == kChunkIndex) {
      indexed.push_back(span);
    }
  }
  ASSERT_GE(chunks.size(), 3U);
  EXPECT_EQ(indexed, chunks);
  std::uint64_t next_ns = static_cast<std::uint64_t>(time_us(0)) * 1'000;
  for (const auto& [first_ns, last_ns] : chunks) {
    EXPECT_EQ(first_ns, next_ns) << "each part begins where the previous one ends";
    EXPECT_GE(last_ns, first_ns);
    next_ns = last_ns + 1'000'000;
  }
  EXPECT_EQ(next_ns, static_cast<std::uint64_t>(time_us(kMessages)) * 1'000);
}

}  // namespace
}  // namespace vantage::logs
