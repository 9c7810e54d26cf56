#include "scenario/reader/node.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::scenario {

const Node& TreeBuilder::add(Node::Kind kind, int line, std::string text) {
  constexpr std::size_t kDepthMax = 32;
  Node& node = nodes_->emplace_back(Node{kind, line, std::move(text), {}});
  if (!open_.empty()) {
    open_.back()->items.push_back(&node);
  }
  if (kind == Node::Kind::kList || kind == Node::Kind::kMapping) {
    open_.push_back(&node);
    if (open_.size() > kDepthMax) {
      throw StartupError(fmt::format("{}:{}: nested deeper than {}", file_, line, kDepthMax));
    }
  }
  return node;
}

void TreeBuilder::add_alias(const Node& node) { open_.back()->items.push_back(&node); }

std::shared_ptr<const Node> TreeBuilder::root() const {
  return nodes_->empty() ? nullptr : std::shared_ptr<const Node>(nodes_, &nodes_->front());
}

}  // namespace vantage::scenario
