#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "logs/export/csv.hpp"
#include "logs/export/csv_export.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/record/log_writer.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"
#include "test/logs/file_support.hpp"

// Tests the properties that all log exports share.

namespace vantage::logs {
namespace {

using Progress = std::function<void(double)>;
using Stop = std::function<bool()>;
using Left = std::map<std::string, std::int64_t>;

struct Export {
  std::string name;
  std::function<ExportCounts(const IndexedLog&, const std::string& path, ChannelFilter&,
                             const Progress&, const Stop&)>
      run;
};

std::vector<Export> exports() {
  return {{"csv", [](const IndexedLog& log, const std::string& path, ChannelFilter& channels,
                     const Progress& progress,
                     const Stop& stop) { return export_csv(log, path, channels, progress, stop); }},
          {"mcap",
           [](const IndexedLog& log, const std::string& path, ChannelFilter& channels,
              const Progress& progress, const Stop& stop) {
             return export_mcap(log, path, channels, false, progress, stop);
           }},
          {"ros2", [](const IndexedLog& log, const std::string& path, ChannelFilter& channels,
                      const Progress& progress, const Stop& stop) {
             return export_ros2(log, path, channels, progress, stop);
           }}};
}

class ExportTest : public ::testing::Test {
 protected:
  template <class Message>
  void add(const std::string& channel) {
    log_.write(from_utime(++utime_), channel,
               vantage::test::encoded(vantage::test::sample<Message>(sampler_)));
  }
  void add_bytes(const std::string& channel, const test::Bytes& bytes) {
    log_.write(from_utime(++utime_), channel, bytes);
  }
  IndexedLog log() {
    log_.close();
    return IndexedLog(folder_.file("a.lcmlog"));
  }
  test::TemporaryFolder folder_;
  vantage::test::Sampler sampler_{9};
  std::int64_t utime_ = 1'700'000'000'000'000;
  LogWriter log_{folder_.file("a.lcmlog")};
};

TEST_F(ExportTest, ReportsProgressEveryThousandEvents) {
  const auto data = vantage::test::encoded(vantage::test::sample<models::VehicleStatus>(sampler_));
  for (int i = 0; i < 2'500; ++i) {
    add_bytes("VEHICLE_Q1", test::Bytes(data.begin(), data.end()));
  }
  const IndexedLog whole = log();
  for (const Export& each : exports()) {
    std::vector<double> shares;
    ChannelFilter all;
    const ExportCounts counts = each.run(
        whole, folder_.file(each.name), all, [&](double share) { shares.push_back(share); },
        [] { return false; });
    ASSERT_EQ(shares.size(), 3U) << each.name;
    EXPECT_NEAR(shares[0], 999.0 / 2500.0, 1e-9) << each.name;
    EXPECT_NEAR(shares[1], 1999.0 / 2500.0, 1e-9);
    EXPECT_EQ(shares[2], 1.0);
    EXPECT_EQ(counts.messages, 2'500U);
    EXPECT_FALSE(counts.is_stopped);
    EXPECT_EQ(counts.failure, "");
  }
}

TEST_F(ExportTest, EndsOnRequest) {
  for (int i = 0; i < 10; ++i) {
    add<models::VehicleStatus>(i % 2 == 0 ? "VEHICLE_Q1" : "VEHICLE_Q2");
  }
  const IndexedLog whole = log();
  for (const Export& each : exports()) {
    int checks = 0;
    ChannelFilter all;
    const ExportCounts counts =
        each.run(whole, folder_.file(each.name), all, {}, [&] { return ++checks > 7; });
    EXPECT_TRUE(counts.is_stopped) << each.name;
    EXPECT_EQ(counts.messages, 7U) << each.name;
    EXPECT_EQ(counts.failure, "");
  }
  for (const char* name : {"VEHICLE_Q1", "VEHICLE_Q2"}) {
    const test::Bytes table = test::read_file(folder_.file("csv") + "/" + name + ".csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), name[9] == '1' ? 1 + 4 : 1 + 3);
    EXPECT_EQ(table.back(), '\n');
  }
}

// Only selected channels are written or counted as left out.
TEST_F(ExportTest, WritesAndCountsSelectedChannels) {
  add<models::VehicleStatus>("VEHICLE_Q1");
  add<models::VehicleStatus>("VEHICLE_Q2");
  add_bytes("FOREIGN", {1, 2, 3});
  add_bytes("OTHER", {1, 2, 3});
  add_bytes("FOREIGN", {});
  const IndexedLog whole = log();
  for (const Export& each : exports()) {
    ChannelFilter some({"VEHICLE_Q2", "FOREIGN"}, {});
    const ExportCounts counts =
        each.run(whole, folder_.file(each.name), some, {}, [] { return false; });
    EXPECT_EQ(counts.messages, 1U) << each.name;
    EXPECT_EQ(counts.left_out, (Left{{"FOREIGN", 2}})) << each.name;
  }
}

TEST_F(ExportTest, ToRos2OmitsTypesWithoutCounterpart) {
  add<models::AttackNotice>("ATTACK");
  add<models::VehicleStatus>("VEHICLE_Q1");
  add<models::RobotPlan>("EXTERNAL_PLAN_Q1");
  add_bytes("EXTERNAL_FRAME", {1});
  add_bytes("FOREIGN", {1});
  const IndexedLog whole = log();
  ChannelFilter all;
  const ExportCounts counts = export_ros2(whole, folder_.file("a.mcap"), all);
  EXPECT_EQ(counts.messages, 1U);
  EXPECT_EQ(counts.left_out, (Left{{"FOREIGN", 1}}));
}

TEST_F(ExportTest, ToMcapContainsDrawingsOnlyOnRequest) {
  add<models::MocapFrame>("VICON");
  add<models::CollisionReport>("COLLISION");
  const IndexedLog whole = log();
  ChannelFilter none({"NOBODY"}, {});
  EXPECT_EQ(export_mcap(whole, folder_.file("a.mcap"), none, false).messages, 0U);
  EXPECT_GE(export_mcap(whole, folder_.file("b.mcap"), none, true).messages, 3U)
      << "transforms, tracks and an event";
}

TEST_F(ExportTest, ReportsFilesThatCannotBeCreated) {
  add<models::VehicleStatus>("VEHICLE_Q1");
  const IndexedLog whole = log();
  test::write_file(folder_.file("file"), {1});
  std::filesystem::create_directories(folder_.file("csv/VEHICLE_Q1.csv"));
  const auto why_not = [&](const std::string& path) {
    ChannelFilter all;
    try {
      export_csv(whole, path, all);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why_not(folder_.file("file/x")),
            folder_.file("file/x") + ": cannot be created: Not a directory");
  EXPECT_EQ(why_not(folder_.file("csv")),
            folder_.file("csv/VEHICLE_Q1.csv") + ": cannot be written: Is a directory");
}

/// Returns the cells of a line of a table without quotes.
std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out{""};
  for (const char c : line) {
    if (c == ',') {
      out.emplace_back();
    } else if (c != '\r' && c != '\n') {
      out.back() += c;
    }
  }
  return out;
}

TEST(CsvTable, HasColumnsInFieldOrder) {
  const CsvTable table(*bus::find_wire_schema("mocap_frame_t"));
  EXPECT_EQ(table.header(),
            "log_utime,utime,run_id,sequence,arrival_utime,frame_number,num_bodies,bodies.name,"
            "bodies.position_world_m_0,bodies.position_world_m_1,bodies.position_world_m_2,"
            "bodies.quaternion_wxyz_0,bodies.quaternion_wxyz_1,bodies.quaternion_wxyz_2,"
            "bodies.quaternion_wxyz_3,bodies.occluded\r\n");
  vantage_lcm::mocap_frame_t frame{};
  frame.utime = 1;
  frame.run_id = 2;
  frame.sequence = 3;
  frame.arrival_utime = 4;
  frame.frame_number = 5;
  EXPECT_EQ(table.lines(from_utime(9), test::encoded(frame)), "9,1,2,3,4,5,0,,,,,,,,,\r\n");
  frame.num_bodies = 2;
  frame.bodies.resize(2);
  for (int i = 0; i < 2; ++i) {
    vantage_lcm::mocap_body_t& body = frame.bodies[static_cast<std::size_t>(i)];
    body.name = i == 0 ? "Q1" : "Q2";
    for (int k = 0; k < 3; ++k) {
      body.position_world_m[k] = 10 * i + k + 0.5;
    }
    for (int k = 0; k < 4; ++k) {
      body.quaternion_wxyz[k] = 10 * i + k + 0.25;
    }
  }
  EXPECT_EQ(table.lines(from_utime(9), test::encoded(frame)),
            "9,1,2,3,4,5,2,Q1,0.5,1.5,2.5,0.25,1.25,2.25,3.25,false\r\n"
            "9,1,2,3,4,5,2,Q2,10.5,11.5,12.5,10.25,11.25,12.25,13.25,false\r\n");
}

// Only the first list of structs becomes rows. Another list, such as `inputs`, is written into one
// cell.
TEST(CsvTable, WritesRangesAndInputsIntoOneCellEach) {
  vantage_lcm::scan_t scan{};
  scan.robot = "line\none";
  scan.num_beams = 3;
  scan.range_m = {0.5, 1.0, 1.5};
  scan.num_inputs = 2;
  scan.inputs = {{"SCAN", 1, 2}, {"POSE", 3, 4}};
  const CsvTable table(*bus::find_wire_schema("scan_t"));
  const auto names = cells(table.header());
  EXPECT_EQ(std::count(names.begin(), names.end(), "range_m"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "inputs"), 1);
  const std::string line = table.lines(from_utime(9), test::encoded(scan));
  EXPECT_NE(line.find(",\"line\none\","), std::string::npos) << line;
  EXPECT_NE(line.find(",3,\"[0.5,1.0,1.5]\",2,"), std::string::npos) << line;
  std::string inputs =
      nlohmann::ordered_json::array({{{"channel", "SCAN"}, {"run_id", 1}, {"sequence", 2}},
                                     {{"channel", "POSE"}, {"run_id", 3}, {"sequence", 4}}})
          .dump();
  for (std::size_t at = 0; (at = inputs.find('"', at)) != std::string::npos; at += 2) {
    inputs.insert(at, 1, '"');
  }
  EXPECT_TRUE(line.ends_with(",2,\"" + inputs + "\"\r\n")) << line;
}

}  // namespace
}  // namespace vantage::logs
