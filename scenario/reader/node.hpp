#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Tree of a YAML or JSON file: parsers build it and value.hpp reads it.

namespace vantage::scenario {

/// Node of the tree.
struct Node {
  enum class Kind : std::uint8_t {
    kNothing,  ///< null, or a key without a value
    kText,     ///< quoted text
    kLiteral,  ///< JSON only: number, true or false; not a text
    kWord,     ///< YAML scalar without quotes: text, number, true or false
    kList,
    kMapping
  };

  Kind kind = Kind::kNothing;
  int line = 0;                    ///< from 1; 0: unknown
  std::string text;                ///< content of a scalar
  std::vector<const Node*> items;  ///< elements of a list; for a mapping: key, value, key, value, …

  [[nodiscard]] bool is_scalar() const {
    return kind == Kind::kText || kind == Kind::kLiteral || kind == Kind::kWord;
  }
  [[nodiscard]] std::size_t entry_count() const { return items.size() / 2; }
  [[nodiscard]] const Node& key(std::size_t entry) const { return *items[2 * entry]; }
  [[nodiscard]] const Node& value(std::size_t entry) const { return *items[2 * entry + 1]; }
};

/// Builder of a tree. Nodes are added in the order in which a parser finds them.
class TreeBuilder {
 public:
  /// `file` is the file name in error messages.
  explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

  /// Appends a node to the innermost open list or mapping, or as the root. A list or mapping stays
  /// open until close().
  /// @throws StartupError "file:line: …" when nodes are nested more than 32 levels deep.
  const Node& add(Node::Kind kind, int line, std::string text = "");
  /// Appends `node` of this tree again.
  void add_alias(const Node& node);
  void close() { open_.pop_back(); }

  /// Returns the root; nullptr before the first add(). The pointer keeps the tree alive.
  [[nodiscard]] std::shared_ptr<const Node> root() const;

 private:
  std::string file_;
  std::shared_ptr<std::deque<Node>> nodes_ = std::make_shared<std::deque<Node>>();
  std::vector<Node*> open_;
};

}  // namespace vantage::scenario
