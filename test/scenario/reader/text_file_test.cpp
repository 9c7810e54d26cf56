#include "scenario/reader/text_file.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/node.hpp"
#include "scenario/reader/yaml_document.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::scenario {
namespace {

constexpr TextRule kOfSixBytes{.expected = "a word", .bytes_max = 6};

std::string refusal_of(const std::string& text, const TextRule& rule) {
  try {
    check_text(text, "f", rule);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

std::string refusal_of_file(const std::string& path, const TextRule& rule) {
  try {
    return "taken: " + read_text_file(path, rule);
  } catch (const StartupError& error) {
    return error.what();
  }
}

TEST(CheckText, LimitsTheNumberOfBytes) {
  EXPECT_EQ(refusal_of("abcdef", kOfSixBytes), "taken");
  EXPECT_EQ(refusal_of("abcdefg", kOfSixBytes), "f: must be at most 6 bytes");
  EXPECT_EQ(refusal_of(std::string(1'048'576, 'a'), kScenarioText), "taken");
  EXPECT_EQ(refusal_of(std::string(1'048'577, 'a'), kScenarioText),
            "f: must be at most 1048576 bytes");
}

TEST(CheckText, AcceptsPrintableTextAndNamesTheBadLine) {
  const TextRule rule{.expected = "a text", .bytes_max = 1000};
  for (int byte = 1; byte < 0x80; ++byte) {
    const std::string text = std::string("a\r\n\xC3\xA4\n") + static_cast<char>(byte);
    const bool may_be = (byte >= 0x20 && byte < 0x7F) || byte == '\n' || byte == '\r';
    const std::string answer = refusal_of(text, rule);
    EXPECT_EQ(answer == "taken", may_be) << byte;
    if (!may_be) {
      EXPECT_EQ(answer.find(byte == '\t' ? "f:3: tab character; use spaces"
                                         : "f:3: control character 0x"),
                0U)
          << answer;
    }
  }
  EXPECT_EQ(refusal_of("\x7F", rule), "f:1: control character 0x7f");
  TextRule with_tabs = rule;
  with_tabs.may_have_tabs = true;
  EXPECT_EQ(refusal_of("a\tb", with_tabs), "taken");
  EXPECT_EQ(refusal_of("a\n\n\xC3", rule), "f:3: byte 0xc3 is not UTF-8 text");
}

TEST(ReadTextFile, ReadsWholeFilesOfAllowedLength) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("text");
  // Files are read in blocks of 64 KiB. The sizes are less than one block, exactly one block, one
  // block and one byte, and more than three blocks.
  for (const std::size_t bytes : {0U, 5U, 65'535U, 65'536U, 65'537U, 200'000U}) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) {
      text += static_cast<char>('a' + i % 23);
    }
    std::ofstream(path) << text;
    const TextRule just{.expected = "a text", .bytes_max = bytes};
    EXPECT_TRUE(read_text_file(path, just) == text) << bytes;
    if (bytes > 0) {
      const TextRule less{.expected = "a text", .bytes_max = bytes - 1};
      EXPECT_EQ(refusal_of_file(path, less),
                path + ": must be at most " + std::to_string(bytes - 1) + " bytes");
    }
  }
}

TEST(ReadTextFile, ReadsPipesOnlyIfAllowed) {
  TextRule rule = kOfSixBytes;
  EXPECT_EQ(refusal_of_file("/dev/null", rule), "/dev/null: cannot be read");
  rule.may_be_pipe = true;
  EXPECT_EQ(refusal_of_file("/dev/null", rule), "taken: ");
  EXPECT_EQ(refusal_of_file("/dev/zero", rule), "/dev/zero: must be at most 6 bytes");
  EXPECT_EQ(refusal_of_file("/tmp", rule), "/tmp: is a directory; expected a word file");
  EXPECT_EQ(refusal_of_file("/nowhere/at/all", rule), "/nowhere/at/all: no such file");
}

TEST(TreeBuilder, LimitsTheNestingDepth) {
  for (const auto kind : {Node::Kind::kList, Node::Kind::kMapping}) {
    TreeBuilder tree("f");
    EXPECT_EQ(tree.root(), nullptr);
    for (int depth = 1; depth <= 32; ++depth) {
      tree.add(kind, depth);
    }
    tree.add(Node::Kind::kWord, 33, "leaf");
    try {
      tree.add(kind, 34);
      ADD_FAILURE() << "the file was not refused";
    } catch (const StartupError& error) {
      EXPECT_STREQ(error.what(), "f:34: nested deeper than 32");
    }
  }
}

TEST(TreeBuilder, AddsEachNodeToTheOpenParent) {
  TreeBuilder tree("f");
  const Node& list = tree.add(Node::Kind::kList, 1);
  const Node& word = tree.add(Node::Kind::kWord, 2, "word");
  const Node& inner = tree.add(Node::Kind::kList, 3);
  tree.add(Node::Kind::kText, 4, "in");
  tree.close();
  tree.add_alias(word);
  tree.close();
  EXPECT_EQ(tree.root().get(), &list);
  ASSERT_EQ(list.items.size(), 3U);
  EXPECT_EQ(list.items[0], &word);
  EXPECT_EQ(list.items[1], &inner);
  EXPECT_EQ(list.items[2], &word);
  ASSERT_EQ(inner.items.size(), 1U);
  EXPECT_EQ(inner.items[0]->text, "in");
  EXPECT_EQ(inner.items[0]->line, 4);
}

TEST(ParseYaml, RecordsTheLineOfEveryNode) {
  const Value root = parse_yaml("# first\na:\n  - b\n  - c: d\n'e': |\n  f\n", "f");
  const Node& node = *root.node;
  ASSERT_EQ(node.entry_count(), 2U);
  EXPECT_EQ(node.line, 2);
  EXPECT_EQ(node.key(0).line, 2);
  EXPECT_EQ(node.key(0).kind, Node::Kind::kWord);
  EXPECT_EQ(node.value(0).kind, Node::Kind::kList);
  ASSERT_EQ(node.value(0).items.size(), 2U);
  EXPECT_EQ(node.value(0).items[0]->line, 3);
  EXPECT_EQ(node.value(0).items[1]->key(0).line, 4);
  EXPECT_EQ(node.value(0).items[1]->value(0).text, "d");
  EXPECT_EQ(node.key(1).line, 5);
  EXPECT_EQ(node.key(1).kind, Node::Kind::kText);
  EXPECT_EQ(node.value(1).text, "f\n");
}

TEST(ParseYaml, RefusesASecondDocument) {
  for (const char* second : {"a", "[a]", "{a: 1}"}) {
    try {
      static_cast<void>(parse_yaml(std::string("a: 1\n---\n\n") + second + "\n", "f"));
      ADD_FAILURE() << second;
    } catch (const StartupError& error) {
      EXPECT_STREQ(error.what(),
                   "f:4: a second YAML document begins here; a "
                   "file may contain only one");
    }
  }
  try {
    static_cast<void>(parse_yaml("a: 1\n---\n~\n", "f"));
    ADD_FAILURE() << "no value was returned";
  } catch (const StartupError& error) {
    EXPECT_STREQ(error.what(),
                 "f:1: a second YAML document begins here; a "
                 "file may contain only one");
  }
}

}  // namespace
}  // namespace vantage::scenario
