#include "scenario/reader/value.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/mapping.hpp"
#include "scenario/reader/yaml_document.hpp"

namespace vantage::scenario {
namespace {

std::string refusal(const std::function<void()>& reading) {
  try {
    reading();
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

Value yaml(const std::string& text) { return parse_yaml(text, "f"); }

std::string refusal_of_number(const std::string& text, const Range& range = any_number()) {
  return refusal([&] { static_cast<void>(yaml(text).number(range)); });
}

TEST(Range, IncludesAndDescribesItsEnds) {
  const struct {
    Range range;
    bool has_min;
    bool has_max;
    const char* words;
  } all[] = {
      {from_to(-1.0, 4.0), true, true, "at least -1 and at most 4"},
      {above_to(-1.0, 4.0), false, true, "above -1 and at most 4"},
      {from_below(-1.0, 4.0), true, false, "at least -1 and below 4"},
      {{-1.0, 4.0, true, true}, false, false, "above -1 and below 4"},
  };
  for (const auto& each : all) {
    EXPECT_EQ(each.range.description(), each.words);
    EXPECT_EQ(each.range.contains(-1.0), each.has_min) << each.words;
    EXPECT_EQ(each.range.contains(4.0), each.has_max) << each.words;
    for (const double inside : {-0.999, 0.0, 3.999}) {
      EXPECT_TRUE(each.range.contains(inside)) << each.words;
    }
    for (const double outside : {-1.001, 4.001}) {
      EXPECT_FALSE(each.range.contains(outside)) << each.words;
    }
    const Range half = each.range.scaled(0.5);
    EXPECT_EQ(half.contains(-0.5), each.has_min) << each.words;
    EXPECT_EQ(half.contains(2.0), each.has_max) << each.words;
    EXPECT_TRUE(half.contains(-0.499) && half.contains(1.999)) << each.words;
    EXPECT_FALSE(half.contains(-0.501) || half.contains(2.001)) << each.words;
  }
  EXPECT_EQ(any_number().description(), "a number");
  EXPECT_EQ(at_least(3.0).description(), "at least 3");
  EXPECT_EQ(above(3.0).description(), "above 3");
  EXPECT_EQ((Range{-kNoLimit, 5.0}).description(), "at most 5");
  EXPECT_EQ((Range{-kNoLimit, 5.0, false, true}).description(), "below 5");
  EXPECT_TRUE(any_number().contains(1e300) && any_number().contains(-1e300));
  EXPECT_TRUE(at_least(3.0).contains(3.0) && at_least(3.0).contains(1e300));
  EXPECT_FALSE(at_least(3.0).contains(2.9) || above(3.0).contains(3.0));
}

TEST(Value, ReadsNumbersWithAnySign) {
  EXPECT_EQ(yaml("+7.5").number(any_number()), 7.5);
  EXPECT_EQ(yaml("-7.5").number(any_number()), -7.5);
  EXPECT_EQ(yaml("+7").integer(0, 9), 7);
  EXPECT_EQ(yaml("-7").integer(-9, 0), -7);
  EXPECT_EQ(yaml("+7").unsigned_integer(), 7U);
  for (const char* none : {"+-7", "++7", "+", "7 8", "7_", "0x7"}) {
    EXPECT_EQ(refusal_of_number(none), std::string("f:1: must be a number, is '") + none + "'");
  }
  for (const char* infinite : {".inf", "-.inf", ".nan", "inf", "-inf", "nan"}) {
    EXPECT_EQ(refusal_of_number(infinite),
              std::string("f:1: must be a finite number, is '") + infinite + "'");
  }
  EXPECT_EQ(refusal_of_number("{a: 1}"), "f:1: must be a number, is a mapping");
  EXPECT_EQ(refusal_of_number("5", above_to(5.0, 6.0)), "f:1: must be above 5 and at most 6, is 5");
}

TEST(Value, LimitsIntegers) {
  const auto answer = [](const std::string& text) {
    return refusal([&] { static_cast<void>(yaml(text).integer(-3, 11)); });
  };
  EXPECT_EQ(yaml("-3").integer(-3, 11), -3);
  EXPECT_EQ(yaml("11").integer(-3, 11), 11);
  EXPECT_EQ(answer("-4"), "f:1: must be at least -3 and at most 11, is '-4'");
  EXPECT_EQ(answer("12"), "f:1: must be at least -3 and at most 11, is '12'");
  EXPECT_EQ(answer("9223372036854775808"),
            "f:1: must be at least -3 and at most 11, is '9223372036854775808'");
  EXPECT_EQ(answer("1e1"), "f:1: must be a whole number, is '1e1'");
  EXPECT_EQ(answer("'7'"), "f:1: must be a plain number, is the text '7'");
  EXPECT_EQ(refusal([] { static_cast<void>(yaml("-1").unsigned_integer()); }),
            "f:1: must be a whole number of at least 0 and at most 18446744073709551615, is '-1'");
}

TEST(Value, ReadsUnquotedFlagsOnly) {
  EXPECT_TRUE(yaml("true").flag());
  EXPECT_FALSE(yaml("false").flag());
  for (const char* none : {"'true'", "\"false\"", "True", "yes", "1", "[true]"}) {
    EXPECT_NE(refusal([&] {
                static_cast<void>(yaml(none).flag());
              }).find("f:1: must be true or false, is "),
              std::string::npos)
        << none;
  }
}

TEST(Value, ReadsTextWithOrWithoutQuotes) {
  EXPECT_EQ(yaml("'a b'").text(), "a b");
  EXPECT_EQ(yaml("a").text(), "a");
  EXPECT_EQ(yaml("7").text(), "7") << "plain YAML words need no quotes";
  EXPECT_EQ(yaml("''").text_or_empty(), "");
  EXPECT_EQ(refusal([] { static_cast<void>(yaml("''").text()); }), "f:1: must not be empty");
  EXPECT_EQ(refusal([] { static_cast<void>(yaml("[a]").text()); }), "f:1: must be text, is a list");
  EXPECT_EQ(refusal([] { static_cast<void>(yaml("{a: 1}").text()); }),
            "f:1: must be text, is a mapping");
  const auto literal = std::make_shared<const Node>(Node{Node::Kind::kLiteral, 3, "12.5", {}});
  EXPECT_EQ(refusal([&] {
              static_cast<void>(Value{literal, "f", "a.b", 3}.text());
            }),
            "f:3: a.b: must be text in quotes, is 12.5");
  EXPECT_EQ((Value{literal, "f", "a.b", 3}.number(any_number())), 12.5);
  const auto yes = std::make_shared<const Node>(Node{Node::Kind::kLiteral, 3, "true", {}});
  EXPECT_TRUE((Value{yes, "f", "a.b", 3}.flag()));
}

TEST(Value, ReturnsItemsInOrderWithTheirPath) {
  const Value list = yaml("- 1.5\n-\n  - 2\n  - 4\n- ~\n- 8\n");
  const std::vector<Value> items = list.items();
  ASSERT_EQ(items.size(), 4U);
  EXPECT_EQ(items[0].path, "[0]");
  EXPECT_EQ(items[0].line, 1);
  EXPECT_EQ(items[0].number(any_number()), 1.5);
  EXPECT_EQ(items[1].point(any_number()), Eigen::Vector2d(2.0, 4.0));
  EXPECT_EQ(items[1].items()[1].path, "[1][1]");
  EXPECT_EQ(items[1].items()[1].line, 4);
  EXPECT_EQ(items[2].line, 1) << "an empty item has the line of its list";
  EXPECT_EQ(refusal([&] { static_cast<void>(items[2].number(any_number())); }),
            "f:1: [2]: must be a number, is nothing");
  EXPECT_EQ(items[3].line, 6);
  EXPECT_EQ(items[1].numbers(2, "two", any_number()), (std::vector<double>{2.0, 4.0}));
  EXPECT_EQ(refusal([&] { static_cast<void>(items[1].items(3, "three things")); }),
            "f:3: [1]: must be a list of three things, is a list of 2");
  EXPECT_EQ(refusal([&] { static_cast<void>(items[3].items(3, "three things")); }),
            "f:6: [3]: must be a list of three things, is '8'");
  EXPECT_EQ(refusal([&] { static_cast<void>(items[1].point(from_to(2.0, 3.0))); }),
            "f:4: [1][1]: must be at least 2 and at most 3, is 4");
  EXPECT_EQ(refusal([&] { static_cast<void>(items[3].items()); }),
            "f:6: [3]: must be a list, is '8'");
}

TEST(Value, ReadsEnumerators) {
  enum class Colour { kRed, kGreen, kBlue };
  const auto colour = [](const std::string& text) {
    return yaml(text).choice<Colour>(
        {{"red", Colour::kRed}, {"green", Colour::kGreen}, {"blue", Colour::kBlue}});
  };
  EXPECT_EQ(colour("red"), Colour::kRed);
  EXPECT_EQ(colour("'green'"), Colour::kGreen);
  EXPECT_EQ(colour("blue"), Colour::kBlue);
  EXPECT_EQ(refusal([&] { static_cast<void>(colour("[red]")); }),
            "f:1: must be one of red, green, blue; is a list");
  EXPECT_EQ(refusal([&] { static_cast<void>(colour("Red")); }),
            "f:1: must be one of red, green, blue; is 'Red'");
}

TEST(Shortened, KeepsFortyBytesOfWholeCharacters) {
  EXPECT_EQ(shortened(std::string(40, 'a')), std::string(40, 'a'));
  EXPECT_EQ(shortened(std::string(41, 'a')), std::string(40, 'a') + "…");
  EXPECT_EQ(shortened("abc", 2), "ab…");
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("", 3), "");
  EXPECT_EQ(shortened("aäb", 2), "aä…") << "characters are not split";
  EXPECT_EQ(shortened("aä", 2), "aä");
  EXPECT_EQ(shortened("\xFF\xFF\xFF", 2), "\xFF\xFF…")
      << "bytes that are not text count as one each";
}

TEST(DiffersInUnit, ComparesTheLastPartOfTheName) {
  EXPECT_TRUE(differs_in_unit("range_m", "range_mm"));
  EXPECT_TRUE(differs_in_unit("range", "range_m"));
  EXPECT_TRUE(differs_in_unit("range_max_kmh", "range_max_mps"));
  EXPECT_FALSE(differs_in_unit("range_m", "range_m"));
  EXPECT_FALSE(differs_in_unit("range_min", "range_max")) << "min is a unit, max is not";
  EXPECT_FALSE(differs_in_unit("range_m", "rage_m"));
  EXPECT_FALSE(differs_in_unit("m_range", "mm_range"));
}

/// Returns the edit distance by its recursive definition.
std::size_t edits(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) {
    return a.size() + b.size();
  }
  const std::size_t both = edits(a.substr(1), b.substr(1));
  return a[0] == b[0] ? both : 1 + std::min({both, edits(a.substr(1), b), edits(a, b.substr(1))});
}

// Compares with the recursive definition, on words so similar that all distances occur.
TEST(NearestWord, IsTheFirstWordWithFewestEditsUpToALimit) {
  std::mt19937 random(7);
  const auto any_word = [&](std::size_t least, std::size_t most) {
    std::string word(least + random() % (most - least + 1), 'a');
    for (char& letter : word) {
      letter = static_cast<char>('a' + random() % 3);
    }
    return word;
  };
  int near = 0;
  constexpr int kDraws = 100;
  for (int draw = 0; draw < kDraws; ++draw) {
    const std::string word = any_word(3, 9);
    std::vector<std::string> known;
    for (int i = 0; i < 4; ++i) {
      known.push_back(any_word(1, 6));
    }
    std::string expected;
    std::size_t fewest = std::max<std::size_t>(2, word.size() / 3) + 1;
    for (const std::string& each : known) {
      if (edits(word, each) < fewest) {
        fewest = edits(word, each);
        expected = each;
      }
    }
    near += expected.empty() ? 0 : 1;
    EXPECT_EQ(nearest_word(word, {known.begin(), known.end()}), expected) << word;
  }
  EXPECT_GT(near, kDraws / 4);
  EXPECT_LT(near, kDraws);
}

TEST(NearestWord, AllowsTwoEditsOrAThirdOfTheLength) {
  EXPECT_EQ(nearest_word("abxy", {"abcd"}), "abcd");
  EXPECT_EQ(nearest_word("axyz", {"abcd"}), "");
  EXPECT_EQ(nearest_word("abcdefxyz", {"abcdefghi"}), "abcdefghi");
  EXPECT_EQ(nearest_word("abcdewxyz", {"abcdefghi"}), "");
  EXPECT_EQ(nearest_word("abcdefghxyz", {"abcdefghi"}), "abcdefghi")
      << "two additional letters, one different letter";
}

// A name with another unit is preferred to a nearer name, for units of any length.
TEST(NearestWord, PrefersTheSameNameWithAnotherUnit) {
  EXPECT_EQ(nearest_word("range_km", {"range_k", "range_m"}), "range_m");
  EXPECT_EQ(nearest_word("range_km", {"range_m", "range_k"}), "range_m");
  EXPECT_EQ(nearest_word("turn_radps", {"turn_deg", "turn_radpz"}), "turn_deg");
  EXPECT_EQ(nearest_word("q_radps", {"q"}), "q");
  EXPECT_EQ(nearest_word("seed_min", {"name", "seed"}), "seed");
}

// The row of an absent key contains rule and default; the row of a present key also contains its
// line. Items of a list share a row.
TEST(KeyTable, ListsEachKeyOfTheReader) {
  KeyTable table;
  Value document = parse_yaml("speed_mps: 2\nrobots:\n  - {name: A}\n  - {name: B}\n", "");
  document.keys = &table;
  double speed_mps = 1.0;
  int count = 3;
  read_mapping({document}, [&](Mapping& top) {
    top.number("speed_mps", speed_mps, above(0.0));
    top.integer("count", count, 1, 9);
    const std::optional<Value> robots = top.find_required("robots");
    for (const Value& robot : robots->items()) {
      read_mapping({robot}, [](Mapping& from) {
        std::string name;
        from.text("name", name);
      });
    }
  });
  const auto expect_rule = [&](std::size_t row, const KeyRule& rule) {
    ASSERT_LT(row, table.rules().size());
    const KeyRule& is = table.rules()[row];
    EXPECT_EQ(is.path, rule.path);
    EXPECT_EQ(is.values, rule.values);
    EXPECT_EQ(is.initial, rule.initial);
    EXPECT_EQ(is.is_required, rule.is_required);
    EXPECT_EQ(is.line, rule.line);
  };
  EXPECT_EQ(table.rules().size(), 4U);
  expect_rule(0, {"speed_mps", "above 0", "1", false, 1});
  expect_rule(1, {"count", "a whole number, at least 1 and at most 9", "3", false, 0});
  expect_rule(2, {"robots", "list", "", true, 2});
  expect_rule(3, {"robots[].name", "text", "", false, 3});
}

}  // namespace
}  // namespace vantage::scenario
