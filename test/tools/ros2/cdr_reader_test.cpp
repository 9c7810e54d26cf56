#include "tools/ros2/cdr_reader.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/tools/ros2/ros2_messages.hpp"

namespace vantage::tools::ros2 {
namespace {

TEST(CdrReader, ReadsMessagesWrittenByTheBuilder) {
  logs::Cdr out;
  out.number(std::uint8_t{1}).number(-2.5).text("ab").number(std::uint16_t{3}).text("").count(2);
  out.number(std::int32_t{-4}).number(std::int32_t{5});
  CdrReader in(test::bytes_of(out.bytes()));
  EXPECT_EQ(in.number<std::uint8_t>(), 1);
  EXPECT_EQ(in.number<double>(), -2.5);
  EXPECT_EQ(in.text(), "ab");
  EXPECT_EQ(in.number<std::uint16_t>(), 3);
  EXPECT_EQ(in.text(), "");
  EXPECT_EQ(in.count(sizeof(std::int32_t)), 2U);
  EXPECT_EQ(in.number<std::int32_t>(), -4);
  EXPECT_EQ(in.number<std::int32_t>(), 5);
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.number<std::uint8_t>(), 0);
  EXPECT_FALSE(in.ok());
}

TEST(CdrReader, ReadsBigEndianMessages) {
  const std::vector<std::uint8_t> bytes{0, 0, 0, 0, 0x01, 0, 0x02, 0x03, 0, 0, 0, 2, 'x', 0};
  CdrReader in(bytes);
  EXPECT_EQ(in.number<std::uint8_t>(), 1);
  EXPECT_EQ(in.number<std::uint16_t>(), 0x0203);
  EXPECT_EQ(in.text(), "x");
  EXPECT_TRUE(in.ok());
}

TEST(CdrReader, RefusesOtherEncodings) {
  for (const std::uint8_t encoding : std::vector<std::uint8_t>{2, 3, 6, 7, 10}) {
    const std::vector<std::uint8_t> bytes{0, encoding, 0, 0, 1, 2, 3, 4};
    EXPECT_FALSE(CdrReader(bytes).ok()) << int{encoding};  // parameter lists; version 2
  }
  EXPECT_FALSE(CdrReader(std::span<const std::uint8_t>()).ok());
}

TEST(CdrReader, RefusesLengthsBeyondTheMessage) {
  const std::vector<std::uint8_t> bytes{0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 'a', 'b'};
  CdrReader text(bytes);
  EXPECT_EQ(text.text(), "");
  EXPECT_FALSE(text.ok());
  CdrReader list(bytes);
  EXPECT_EQ(list.count(8), 0U);
  EXPECT_FALSE(list.ok());
  const std::vector<std::uint8_t> open{0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b'};  // without NUL
  CdrReader unterminated(open);
  EXPECT_EQ(unterminated.text(), "");
  EXPECT_FALSE(unterminated.ok());
}

}  // namespace
}  // namespace vantage::tools::ros2
