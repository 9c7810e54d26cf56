#include "logs/export/csv.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "bus/convert/convert.hpp"
#include "logs/export/csv_export.hpp"
#include "logs/record/log_writer.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

const bus::WireSchema& schema_of(const char* name) { return *bus::find_wire_schema(name); }

/// Returns the cells of each line, without their quotes.
std::vector<std::vector<std::string>> parsed(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> line{""};
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      line.back() += text[++i];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && c == ',') {
      line.emplace_back();
    } else if (!is_quoted && c == '\r') {
      ++i;
      lines.push_back(line);
      line = {""};
    } else {
      line.back() += c;
    }
  }
  return lines;
}

TEST(CsvTable, WritesOneLinePerElement) {
  vantage_lcm::mocap_frame_t frame{};
  frame.utime = 5;
  frame.sequence = 7;
  frame.num_bodies = 2;
  frame.bodies.resize(2);
  frame.bodies[0].name = "Q1";
  frame.bodies[1].name = "a \"b\", c";
  frame.bodies[1].position_world_m[2] = 1.25;
  frame.bodies[1].occluded = true;
  const CsvTable table(schema_of("mocap_frame_t"));
  const auto lines = parsed(table.header() + table.lines(from_utime(9), test::encoded(frame)));
  ASSERT_EQ(lines.size(), 3U);
  const auto cell = [&](std::size_t line, const std::string& column) {
    const auto at = std::find(lines[0].begin(), lines[0].end(), column);
    return at == lines[0].end() ? "no such column"
                                : lines[line][static_cast<std::size_t>(at - lines[0].begin())];
  };
  EXPECT_EQ(lines[0][0], "log_utime");
  EXPECT_EQ(lines[2][0], "9");
  EXPECT_EQ(cell(1, "sequence"), "7");
  EXPECT_EQ(cell(2, "sequence"), "7");
  EXPECT_EQ(cell(1, "bodies.name"), "Q1");
  EXPECT_EQ(cell(2, "bodies.name"), "a \"b\", c");
  EXPECT_EQ(cell(2, "bodies.position_world_m_2"), "1.25");
  EXPECT_EQ(cell(2, "bodies.occluded"), "true");
}

TEST(CsvTable, WritesOneLineForAnEmptyMessage) {
  vantage_lcm::mocap_frame_t frame{};
  const CsvTable table(schema_of("mocap_frame_t"));
  const auto lines = parsed(table.lines(from_utime(9), test::encoded(frame)));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].back(), "");
}

TEST(CsvTable, LeavesNonFiniteCellsEmpty) {
  vantage_lcm::plan_t plan{};
  plan.cost_nat = std::numeric_limits<double>::quiet_NaN();
  const CsvTable table(schema_of("plan_t"));
  const auto lines = parsed(table.header() + table.lines(from_utime(9), test::encoded(plan)));
  const auto at = std::find(lines[0].begin(), lines[0].end(), "cost_nat") - lines[0].begin();
  EXPECT_EQ(lines[1][static_cast<std::size_t>(at)], "");
}

TEST(CsvTable, RefusesOtherTypes) {
  const CsvTable table(schema_of("plan_t"));
  EXPECT_EQ(table.lines(from_utime(9), test::encoded(vantage_lcm::attack_t{})), "");
}

template <class Message>
class CsvOf : public ::testing::Test {};
TYPED_TEST_SUITE(CsvOf, vantage::test::MessageTypes);

TYPED_TEST(CsvOf, HasOneCellPerColumnInEveryLine) {
  const CsvTable table(schema_of(bus::WireOf<TypeParam>::getTypeName()));
  const std::size_t columns = parsed(table.header()).at(0).size();
  vantage::test::Sampler sampler(5);
  for (int i = 0; i < 100; ++i) {
    const auto bytes = vantage::test::encoded(vantage::test::sample<TypeParam>(sampler));
    const auto lines = parsed(table.lines(from_utime(1), bytes));
    EXPECT_GE(lines.size(), 1U);
    for (const auto& line : lines) {
      EXPECT_EQ(line.size(), columns);
    }
  }
}

TEST(CsvFileName, StaysInTheFolderAndIsUnique) {
  EXPECT_EQ(csv_file_name("PLAN_Q1"), "PLAN_Q1.csv");
  EXPECT_EQ(csv_file_name("../../evil"), "%2E.%2F..%2Fevil.csv");
  EXPECT_EQ(csv_file_name("/etc/passwd"), "%2Fetc%2Fpasswd.csv");
  EXPECT_EQ(csv_file_name("team/VICON"), "team%2FVICON.csv");
  EXPECT_EQ(csv_file_name("team%2FVICON"), "team%252FVICON.csv");
  EXPECT_EQ(csv_file_name("PLAN_\xFC\n"), "PLAN_%FC%0A.csv");
  for (int a = 0; a < 256; ++a) {
    const std::string name = csv_file_name(std::string(1, static_cast<char>(a)) + "/..");
    EXPECT_EQ(name.find('/'), std::string::npos);
    EXPECT_NE(name.front(), '.');
    for (int b = 0; b < a; ++b) {
      EXPECT_NE(csv_file_name(std::string(1, static_cast<char>(a))),
                csv_file_name(std::string(1, static_cast<char>(b))));
    }
  }
}

TEST(ExportCsv, WritesOneTablePerChannelInItsFolder) {
  test::TemporaryFolder folder;
  {
    LogWriter log(folder.file("a.lcmlog"));
    vantage::test::Sampler sampler(9);
    const auto data = vantage::test::encoded(vantage::test::sample<models::AttackNotice>(sampler));
    for (const char* name : {"ATTACK", "../../evil", "team/ATTACK", "FOREIGN", "MIXED"}) {
      log.write(
          from_utime(1), name,
          std::string_view(name) == "FOREIGN" ? Bytes{1, 2} : Bytes(data.begin(), data.end()));
    }
    log.write(from_utime(2), "MIXED", Bytes{1, 2});
  }
  const IndexedLog log(folder.file("a.lcmlog"));
  ChannelFilter all;
  const std::string inside = folder.file("deep/tables");
  const ExportCounts counts = export_csv(log, inside, all);
  EXPECT_EQ(counts.messages, 4U);
  EXPECT_EQ(counts.failure, "");
  EXPECT_EQ(counts.left_out, (std::map<std::string, std::int64_t>{{"FOREIGN", 1}, {"MIXED", 1}}));
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.file("deep"))) {
    files.insert(entry.path().filename());
  }
  EXPECT_EQ(files, (std::set<std::string>{"tables", "ATTACK.csv", "%2E.%2F..%2Fevil.csv",
                                          "team%2FATTACK.csv", "MIXED.csv"}));
}

TEST(ExportCsv, EndsWithAWholeLineWhenTheDiskIsFull) {
  test::TemporaryFolder folder;
  {
    LogWriter log(folder.file("a.lcmlog"));
    vantage::test::Sampler sampler(9);
    const auto data = vantage::test::encoded(vantage::test::sample<models::AttackNotice>(sampler));
    for (int i = 0; i < 2'000; ++i) {
      log.write(from_utime(i), "ATTACK", data);
    }
  }
  const IndexedLog log(folder.file("a.lcmlog"));
  ChannelFilter all;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{30'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const ExportCounts counts = export_csv(log, folder.file("tables"), all);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(counts.failure,
            folder.file("tables") + "/ATTACK.csv: cannot be written: File too large");
  const Bytes table = test::read_file(folder.file("tables") + "/ATTACK.csv");
  ASSERT_GT(table.size(), 20'000U);
  EXPECT_EQ(table.back(), '\n');
}

}  // namespace
}  // namespace vantage::logs
