#pragma once

#include <cstdint>
#include <span>

#include "core/pose.hpp"
#include "core/reserved_array.hpp"

namespace vantage::planner {

/// Handle of a node, 32 bits: its index in Tree.
using NodeId = std::uint32_t;
inline constexpr NodeId kNoNode = 0xFFFFFFFF;

/// One node of a search tree, 48 bytes. Its belief is stored separately, and only if needed.
struct Node {
  Pose2 world_from_body;
  double cost = 0.0;  ///< accumulated J, plus the terminal value if any
  NodeId parent = kNoNode;
  std::uint32_t posterior = 0;  ///< index of its blocks in Tree; 0: not computed yet
  /// used by the search algorithm: link to the next node of the list that contains this node
  NodeId next = kNoNode;
  std::int16_t control = -1;  ///< control from the parent to this node
  std::uint8_t depth = 0;
  std::uint8_t state = 0;  ///< flags of the search algorithm
};

static_assert(sizeof(Node) == 48);

/// The blocks that the measurements on the path to a node changed, by ascending target. All other
/// targets have the open-loop prediction of the depth.
struct Blocks {
  std::span<const std::uint16_t> targets;
  const double* packed = nullptr;  ///< consecutive, packed_size(layout) doubles each
};

/// Arena of one search: nodes and blocks in flat arrays sized at construction, without pointers and
/// freed only by clear(). 48 bytes per node; blocks only for nodes that were expanded or compared.
/// Memory pages are committed at their first use, or the first ones by prefault().
class Tree {
 public:
  Tree(std::size_t nodes_max, std::size_t block_doubles_max);

  /// Commits the first MiB of each array, so that a search causes no page fault there.
  void prefault();

  void clear();
  /// Adds a node; kNoNode if the arena is full.
  NodeId add(const Node& node) {
    if (node_count_ == nodes_.size()) {
      return kNoNode;
    }
    nodes_[node_count_] = node;
    return static_cast<NodeId>(node_count_++);
  }
  Node& operator[](NodeId id) { return nodes_[id]; }
  const Node& operator[](NodeId id) const { return nodes_[id]; }

  /// Stores a copy of a node's blocks. False if the arena is full.
  bool keep_posterior(NodeId id, std::span<const std::uint16_t> targets,
                      std::span<const double> packed);
  /// Space to write a node's blocks in place, up to the given numbers of targets and doubles; null
  /// if the arena is full. commit_posterior() must follow to store them.
  struct Room {
    std::uint16_t* targets = nullptr;
    double* packed = nullptr;
  };
  [[nodiscard]] Room room_for_posterior(std::size_t targets_max, std::size_t doubles_max);
  void commit_posterior(NodeId id, std::size_t targets, std::size_t doubles);
  [[nodiscard]] bool has_posterior(NodeId id) const { return nodes_[id].posterior != 0; }
  /// Precondition: has_posterior(id).
  [[nodiscard]] Blocks posterior(NodeId id) const;

  [[nodiscard]] std::size_t node_count() const { return node_count_; }
  /// Returns the bytes in use by nodes and blocks.
  [[nodiscard]] std::size_t bytes_used() const;

 private:
  struct Record {
    std::uint32_t targets = 0;
    std::uint32_t doubles = 0;
    std::uint32_t count = 0;
  };
  ReservedArray<Node> nodes_;
  ReservedArray<Record> records_;  ///< record 0 means none
  ReservedArray<std::uint16_t> targets_;
  ReservedArray<double> doubles_;
  std::size_t node_count_ = 0;
  std::size_t record_count_ = 1;
  std::size_t target_count_ = 0;
  std::size_t double_count_ = 0;
};

}  // namespace vantage::planner
