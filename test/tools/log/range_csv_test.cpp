#include "tools/log/range_csv.hpp"

#include <array>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

const std::array kColumns = {ColumnSpec{Quantity::kTime, {"time", "utime"}},
                             ColumnSpec{Quantity::kName, {"beacon", "beacon_id"}},
                             ColumnSpec{Quantity::kLength, {"range", "distance"}}};

Table parse(std::string_view text) { return parse_table(text, "a.csv", kColumns); }

std::string refusal(std::string_view text) {
  try {
    parse(text);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

TEST(ParseTable, FindsColumnsByTheirHeadings) {
  const Table table = parse("range_m,quality,beacon_id,time_s\n12.5,3,A1,0.25\n13,2,7,0.5\n");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].name, "A1");
  EXPECT_EQ(table.rows[0].numbers, (std::vector{0.25, 12.5}));
  EXPECT_EQ(table.rows[1].name, "7");
  EXPECT_EQ(table.not_finite, 0);
}

TEST(ParseTable, UsesTheUnitsOfHeadings) {
  for (const char* header :
       {"time_ms,beacon,range_cm", "Time [ms];Beacon;Range [cm]", "time (ms)\tbeacon\tRange (cm)",
        "\xef\xbb\xbf\"Time ms\",\"beacon\",distance.cm"}) {
    const char separator = std::string_view(header).find(';') != std::string_view::npos    ? ';'
                           : std::string_view(header).find('\t') != std::string_view::npos ? '\t'
                                                                                           : ',';
    const std::string row = std::string("1500") + separator + "4" + separator + "250\r\n";
    const Table table = parse(header + std::string("\r\n") + row);
    ASSERT_EQ(table.rows.size(), 1u) << header;
    EXPECT_DOUBLE_EQ(table.rows[0].numbers[0], 1.5) << header;
    EXPECT_DOUBLE_EQ(table.rows[0].numbers[1], 2.5) << header;
  }
  EXPECT_DOUBLE_EQ(parse("utime,beacon,range\n1500000,1,2\n").rows[0].numbers[0], 1.5);
  EXPECT_DOUBLE_EQ(parse("time_ns,beacon,range_ft\n1e9,1,10\n").rows[0].numbers[1], 3.048);
}

TEST(ParseTable, UsesColumnOrderWithoutAHeader) {
  const Table table = parse("# by hand\n\n0.5 4 2.5\n  1.0   4   2.75  \n");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[1].numbers, (std::vector{1.0, 2.75}));
  EXPECT_NE(refusal("0.5,1,4,2.5\n").find("a.csv:1: 4 cells and no header"), std::string::npos);
}

TEST(ParseTable, CountsRowsWithoutANumber) {
  const Table table = parse(
      "time,beacon,range\n1,4,nan\n2,4,\n3,4,inf\n4,4,-NaN\nN/A,4,2\n5,,2\n6,4,1e999\n7,4,+2\n");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0].numbers[0], 7.0);
  EXPECT_EQ(table.not_finite, 7);
}

TEST(ParseTable, SkipsRepeatedHeaders) {
  EXPECT_EQ(parse("time,beacon,range\n1,4,2\ntime,beacon,range\n2,4,2\n").rows.size(), 2u);
}

TEST(ParseTable, SkipsATruncatedLastLine) {
  const Table torn = parse("time,beacon,range\n1,4,2\n2,4");
  EXPECT_TRUE(torn.is_torn);
  EXPECT_EQ(torn.rows.size(), 1u);
  EXPECT_FALSE(parse("time,beacon,range\n1,4,2").is_torn);
  EXPECT_EQ(parse("time,beacon,range\n1,4,2").rows.size(), 1u);
}

TEST(ParseTable, NamesFileLineAndRule) {
  EXPECT_EQ(refusal("time,beacon,range\n1,4,2\n1,4\n2,4,2\n"),
            "a.csv:3: 2 cells; expected 3, as in the first line");
  EXPECT_EQ(refusal("time,beacon,range\n1,4,far\n"), "a.csv:2: range 'far'; expected a number");
  EXPECT_EQ(refusal("time,beacon,range\n1,4,2.5m\n"), "a.csv:2: range '2.5m'; expected a number");
  EXPECT_EQ(refusal("time,beacon,range,distance\n"),
            "a.csv:1: two columns contain the range: 'range' and 'distance'; expected one");
  EXPECT_EQ(refusal("time,beacon,range_furlong\n"),
            "a.csv:1: no column 'range' with a known unit in 'time,beacon,range_furlong'; "
            "expected time, beacon, range");
  EXPECT_EQ(refusal(""), "a.csv: is empty; expected columns time, beacon, range");
  EXPECT_NE(refusal("\x89PNG\r\n").find("a.csv:1: no column 'time'"), std::string::npos);
}

TEST(ReadTable, NamesAnUnreadableFile) {
  EXPECT_THROW(read_table("none.csv", kColumns), StartupError);
  EXPECT_THROW(read_table("/", kColumns), StartupError);
}

// Cells that contain separators, quotes or line ends are quoted (RFC 4180), as pandas writes them.
TEST(ParseTable, ReadsQuotedCells) {
  const std::string_view tables[] = {
      "time,anchor_m,beacon,range\n1,\"(21, 10)\",4,2.5\n2,\"(3, 4)\",4,3\n",
      "time,note,beacon,range\r\n1,\"says \"\"here, there\"\"\",4,2.5\r\n2,,4,3\r\n",
      "time,note,beacon,range\n1,\"two\nlines\",4,2.5\n2,\"\",\"4\",\"3\"\n",
      "\"time\";\"a, b\";\"beacon\";\"range\"\n1;\";\";4;2.5\n2;\"#\";4;3\n"};
  for (const std::string_view text : tables) {
    const Table table = parse(text);
    ASSERT_EQ(table.rows.size(), 2u) << text;
    EXPECT_EQ(table.rows[0].name, "4") << text;
    EXPECT_EQ(table.rows[0].numbers, (std::vector{1.0, 2.5})) << text;
    EXPECT_EQ(table.rows[1].numbers, (std::vector{2.0, 3.0})) << text;
  }
  EXPECT_EQ(parse("time,beacon,range\n1,\"a \"\"b\"\"\",2\n").rows[0].name, "a \"b\"");
  EXPECT_EQ(refusal("time,note,beacon,range\n1,\"a\nb\",4,2\n1,x,4,far\n"),
            "a.csv:4: range 'far'; expected a number");
  EXPECT_TRUE(parse("time,note,beacon,range\n1,x,4,2\n2,\"torn\n").is_torn);
}

}  // namespace
}  // namespace vantage::tools
