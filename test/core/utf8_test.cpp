#include "core/utf8.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace vantage {
namespace {

TEST(IsUtf8, DistinguishesTextAndBytes) {
  for (const char* text : {"", "VICON", "PLAN_ü", "日本", "a\tb", "\xF0\x9F\x9A\x81"}) {
    EXPECT_TRUE(is_utf8(text)) << readable(text);
  }
  for (const char* bytes : {"PLAN_\xFC", "\x80", "\xC0\xAF", "\xE0\x80\x80", "\xED\xA0\x80",
                            "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\xFF"}) {
    EXPECT_FALSE(is_utf8(bytes)) << readable(bytes);
  }
  EXPECT_FALSE(is_utf8(std::string_view("a\0b", 3)));
}

TEST(Readable, KeepsTextAndEscapesOtherBytes) {
  EXPECT_EQ(readable("PLAN_ü 日本"), "PLAN_ü 日本");
  EXPECT_EQ(readable("PLAN_\xFC"), "PLAN_\\xFC");
  EXPECT_EQ(readable("a\tb\n\x1B[31m"), "a\\x09b\\x0A\\x1B[31m");
  EXPECT_EQ(readable("\\xFC"), "\\x5CxFC");
  EXPECT_EQ(readable("\xE2\x82"), "\\xE2\\x82");
}

// The C1 control CSI acts like ESC [, and a right-to-left override reverses the text after it.
TEST(Printable, EscapesTerminalControlCharacters) {
  const std::vector<std::pair<std::string, std::string>> rows{
      {"PLAN_ü 日本 \\ – \xF0\x9F\x9A\x81", "PLAN_ü 日本 \\ – \xF0\x9F\x9A\x81"},
      {"a\tb\nc", "a\tb\nc"},
      {"\x1B[2J\r\b\x7F", "\\x1B[2J\\x0D\\x08\\x7F"},
      {"\xC2\x9B"
       "2J",
       "\\xC2\\x9B2J"},
      {"\xC2\xA0", "\xC2\xA0"},
      {"\xE2\x80\xAE"
       "x",
       "\\xE2\\x80\\xAEx"},
      {"\xE2\x81\xA9", "\\xE2\\x81\\xA9"},
      {"\xE2\x80\xA6", "\xE2\x80\xA6"},
      {"\x9B"
       "2J\xFF",
       "\\x9B2J\\xFF"}};
  for (const auto& [text, shown] : rows) {
    EXPECT_EQ(printable(text), shown);
    EXPECT_EQ(printable(shown), shown) << "an escaped text is not escaped again";
  }
  EXPECT_EQ(readable("\xC2\x9B\xE2\x80\xAE"), "\\xC2\\x9B\\xE2\\x80\\xAE");
}

TEST(Readable, IsAlwaysUtf8AndInjective) {
  for (int a = 0; a < 256; ++a) {
    const std::string one(1, static_cast<char>(a));
    EXPECT_TRUE(is_utf8(readable(one + "x")));
    for (int b = 0; b < a; ++b) {
      EXPECT_NE(readable(one), readable(std::string(1, static_cast<char>(b))));
    }
  }
}

}  // namespace
}  // namespace vantage
