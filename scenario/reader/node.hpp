#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// A file as a tree, whichever language it is in: what parsers make and value.hpp reads.

namespace vantage::scenario {

/// What stands at one place of a file.
struct Node {
  enum class Kind : std::uint8_t {
    kNothing,  ///< null, or a key without a value
    kText,     ///< in quotes
    kLiteral,  ///< a number, true or false, and no text: JSON's, where texts have quotes
    kWord,     ///< YAML's without quotes: a text, or what a literal is
    kList,
    kMapping
  };

  Kind kind = Kind::kNothing;
  int line = 0;                    ///< 1-based; 0 when the parser does not know
  std::string text;                ///< of a scalar
  std::vector<const Node*> items;  ///< of a list; of a mapping key, value, key, value, …

  [[nodiscard]] bool is_scalar() const {
    return kind == Kind::kText || kind == Kind::kLiteral || kind == Kind::kWord;
  }
  [[nodiscard]] std::size_t entry_count() const { return items.size() / 2; }
  [[nodiscard]] const Node& key(std::size_t entry) const { return *items[2 * entry]; }
  [[nodiscard]] const Node& value(std::size_t entry) const { return *items[2 * entry + 1]; }
};

/// Puts a tree together in the order in which a parser meets its parts.
class TreeBuilder {
 public:
  /// `file` is its name in refusals.
  explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

  /// A part of what is open, or the root. A list and a mapping are open until close().
  /// @throws StartupError "file:line: …" when it is nested deeper than 32.
  const Node& add(Node::Kind kind, int line, std::string text = "");
  /// `node`, of this tree, once more.
  void add_again(const Node& node);
  void close() { open_.pop_back(); }

  /// nullptr before the first part. Lives as long as whoever holds it.
  [[nodiscard]] std::shared_ptr<const Node> root() const;

 private:
  std::string file_;
  std::shared_ptr<std::deque<Node>> nodes_ = std::make_shared<std::deque<Node>>();
  std::vector<Node*> open_;
};

}  // namespace vantage::scenario
