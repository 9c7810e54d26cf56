#include "tools/plan/json_document.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/utf8.hpp"
#include "scenario/reader/mapping.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;
using scenario::any_number;
using scenario::Node;
using scenario::Value;

/// Returns the parser's error for `text`; "" if it is accepted.
std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_json(text, "p.json"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

std::vector<Value> items_of(const std::string& text) { return parse_json(text, "p.json").items(); }

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// Expects `value` to have the same content as nlohmann's own tree; numbers are equal to the bit.
void expect_same(const Value& value, const json& oracle) {
  if (oracle.is_object()) {
    ASSERT_EQ(value.node->kind, Node::Kind::kMapping);
    ASSERT_EQ(value.node->entry_count(), oracle.size());
    for (std::size_t i = 0; i < oracle.size(); ++i) {
      const std::string& key = value.node->key(i).text;
      ASSERT_TRUE(oracle.contains(key)) << key;
      expect_same(child_of(value, key, value.node->key(i), value.node->value(i)), oracle[key]);
    }
  } else if (oracle.is_array()) {
    const std::vector<Value> items = value.items();
    ASSERT_EQ(items.size(), oracle.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      expect_same(items[i], oracle[i]);
    }
  } else if (oracle.is_number()) {
    EXPECT_EQ(bits(value.number(any_number())), bits(oracle.get<double>())) << value.node->text;
  } else if (oracle.is_string()) {
    EXPECT_EQ(value.text_or_empty(), oracle.get<std::string>());
  } else if (oracle.is_boolean()) {
    EXPECT_EQ(value.flag(), oracle.get<bool>());
  } else {
    EXPECT_EQ(value.node->kind, Node::Kind::kNothing);
  }
}

TEST(ParseJson, AgreesWithTheParserOfTheJsonLibrary) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(VANTAGE_SOURCE_DIR "/test/tools/problems")) {
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    expect_same(parse_json(text, entry.path()), json::parse(text));
    ++files;
  }
  EXPECT_GE(files, 2);
}

TEST(ParseJson, ReadsNumbersExactly) {
  std::mt19937_64 rng(5);
  std::string text = "[0, 0.0, -0.0, 1, -1, 12.0, 1e3, 1E+3, 0.1e1, 123456789012345678901234567890";
  text += ", 9007199254740993, 18446744073709551615, -9223372036854775808, 5e-324, 1e308, 2e-308";
  for (int i = 0; i < 20'000; ++i) {
    const double any = std::bit_cast<double>(rng());
    const double usual = std::ldexp(static_cast<double>(rng() >> 11U), -44) - 256.0;
    if (std::isfinite(any)) {
      text += fmt::format(", {}, {:.17g}, {:e}", any, any, any);
    }
    text += fmt::format(", {}, {:.6f}, {:.3f}", usual, usual, std::round(usual));
  }
  text += "]";
  expect_same(parse_json(text, "p.json"), json::parse(text));
}

TEST(ParseJson, ReadsAllEscapes) {
  const char* const text = R"(["", "\"\\\/\b\f\n\r\t", "\u00e9\ud83d\ude00", "é😀", "{[:,]}"])";
  expect_same(parse_json(text, "p.json"), json::parse(text));
  EXPECT_EQ(items_of(text)[1].text(), "\"\\/\b\f\n\r\t");
  EXPECT_EQ(items_of(text)[2].text(), items_of(text)[3].text().substr(0, 6));
}

TEST(ParseJson, RecordsTheLineOfEveryValue) {
  // White space and special characters are between values, in strings and at line ends.
  const std::string text =
      "\xEF\xBB\xBF\n[1,\r\n\t\"a\\\"]\\\\\" , \"\\u000a,\",\n {\"k:{\" :\n\n -1.5e3}\n, [\n], "
      "true\n,"
      "null]\n";
  const std::vector<int> lines = {2, 3, 3, 4, 7, 8, 9};
  const std::vector<Value> items = items_of(text);
  ASSERT_EQ(items.size(), lines.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    EXPECT_EQ(items[i].line, lines[i]) << i;
    EXPECT_EQ(items[i].node->line, lines[i]) << i;
  }
  EXPECT_EQ(items[3].node->key(0).line, 4);
  EXPECT_EQ(items[3].node->value(0).line, 6);
}

TEST(ParseJson, ReadsIntegersInAnyNotation) {
  for (const Value& item : items_of("[12, 12.0, 1.2e1, 120e-1, 12.00]")) {
    EXPECT_EQ(item.integer(0, 100), 12);
  }
  for (const Value& item : items_of("[0, 0.0]")) {
    EXPECT_EQ(item.integer(0, 100), 0);
  }
  for (const Value& item : items_of("[12.5, 1e-400, 1e300, true, \"12\", null]")) {
    EXPECT_THROW(static_cast<void>(item.integer(0, 100)), StartupError) << item.node->text;
  }
}

TEST(ParseJson, DistinguishesTextAndNumbers) {
  const std::vector<Value> items = items_of(R"(["1", 1, "true", true, null])");
  const auto is = [&](std::size_t i) {
    std::string kinds;
    const auto add = [&](const char* kind, const auto& read) {
      try {
        static_cast<void>(read(items[i]));
        kinds += kind;
      } catch (const StartupError&) {
        return;
      }
    };
    add("number", [](const Value& value) { return value.number(any_number()); });
    add("text", [](const Value& value) { return value.text_or_empty(); });
    add("word", [](const Value& value) { return value.choice<int>({{"1", 1}, {"true", 2}}); });
    add("flag", [](const Value& value) { return value.flag(); });
    return kinds;
  };
  EXPECT_EQ(is(0), "textword");
  EXPECT_EQ(is(1), "number");
  EXPECT_EQ(is(2), "textword");
  EXPECT_EQ(is(3), "flag");
  EXPECT_EQ(is(4), "");
}

TEST(ParseJson, RefusesMalformedJsonWithLineAndColumn) {
  struct Refused {
    std::string text;
    std::string refusal;  ///< beginning of the error
  };
  const Refused cases[] = {
      {"{\n  \"T\": 1,\n  \"q\" 2\n}", "p.json:3:7: not JSON: syntax error"},
      {"", "p.json:1: empty file; expected a planning problem"},
      {" \r\n\t", "p.json:1: empty file; expected a planning problem"},
      {"\xEF\xBB\xBF", "p.json:1:4: not JSON: "},
      {"\n{", "p.json:2:2: not JSON: "},
      {"{} x", "p.json:1:4: not JSON: "},
      {"[1\n,1e999]", "p.json:2:6: not JSON: number overflow parsing '1e999'"},
      {"[NaN]", "p.json:1:2: not JSON: "},
      {"[-Infinity]", "p.json:1:3: not JSON: "},
      {"[\"\\ud83d\"]", "p.json:1:9: not JSON: "},
      {"[\"a\tb\"]", "p.json:1:4: not JSON: "},
      {"[\"a\nb\"]", "p.json:1:4: not JSON: "},
      {"[1]\n\x01", "p.json:2: control character 0x01"},
      {std::string("[1]\0", 4), "p.json:1: control character 0x00"},
      {"\n[\"\xC0\xAF\"]", "p.json:2: byte 0xc0 is not UTF-8 text"},
      {std::string(32, '[') + std::string(32, ']'), ""},
      {std::string(32, '[') + "\n[", "p.json:2: nested deeper than 32"},
      {std::string(100'000, '['), "p.json:1: nested deeper than 32"},
      {std::string(kProblemText.bytes_max + 1, ' '), "p.json: must be at most 16777216 bytes"}};
  for (const Refused& refused : cases) {
    const std::string refusal = refusal_of(refused.text);
    EXPECT_TRUE(refused.refusal.empty() ? refusal.empty() : refusal.starts_with(refused.refusal))
        << refused.text.substr(0, 40) << "\nsays " << refusal;
  }
}

// These texts are valid YAML but not JSON.
TEST(ParseJson, RefusesYaml) {
  for (const char* text : {"[1,,2]", "[1,]", "{\"a\": 1,}", "{a: 1}", "{\"a\": .5}", "[01]", "[+1]",
                           "['a']", "[a]", "[1] # one", "a: 1", "- 1", "[0x1F]", "[.inf]", "[~]"}) {
    EXPECT_NE(refusal_of(text).find(": not JSON: "), std::string::npos) << text;
  }
}

TEST(ParseJson, ErrorIsOneShortLine) {
  const std::string text(100'000, 'x');
  for (const std::string& broken :
       {"[\"" + text, "[\"" + text + "\xFF", "[\"" + text + "\n\"]", "[" + text + "]",
        "[\"\\n\\u0001\\ud83d\\ude00" + text, "{\"" + text + "\" 1}"}) {
    const std::string refusal = refusal_of(broken);
    EXPECT_LT(refusal.size(), 200U);
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
    EXPECT_TRUE(is_utf8(refusal)) << refusal;
  }
  const Value unknown = parse_json("{\"\\n" + text + "\": 1}", "p.json");
  try {
    scenario::read_mapping({unknown}, [](scenario::Mapping& /*keys*/) {});
    ADD_FAILURE();
  } catch (const StartupError& error) {
    EXPECT_TRUE(std::string_view(error.what()).starts_with("p.json:1: \\x0Axxx")) << error.what();
    EXPECT_LT(std::string_view(error.what()).size(), 200U);
  }
}

TEST(ParseJson, SurvivesTruncatedFile) {
  std::ifstream file(VANTAGE_SOURCE_DIR "/test/tools/problems/tracking.json");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    EXPECT_FALSE(refusal_of(text.substr(0, length)).empty()) << length;
  }
}

}  // namespace
}  // namespace vantage::tools
