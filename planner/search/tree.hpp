#pragma once

#include <cstdint>
#include <span>

#include "core/pose.hpp"
#include "core/reserved_array.hpp"

namespace vantage::planner {

/// 32-bit handle of a node; also an index into Tree.
using NodeId = std::uint32_t;
inline constexpr NodeId kNoNode = 0xFFFFFFFF;

/// One node of a search tree, 48 bytes. Its belief is kept apart and only where it is needed.
struct Node {
  Pose2 world_from_body;
  double cost = 0.0;  ///< accumulated J
  NodeId parent = kNoNode;
  std::uint32_t posterior = 0;  ///< index of its blocks in Tree, 0: not worked out yet
  NodeId next = kNoNode;        ///< the algorithm's own: in whatever list it keeps the node
  std::int16_t control = -1;    ///< that led here
  std::uint8_t depth = 0;
  std::uint8_t state = 0;  ///< the algorithm's own flags
};

static_assert(sizeof(Node) == 48);

/// The blocks that a node's own history of measurements changed, by ascending target; every other
/// target is at the open-loop prediction that all nodes of the depth share.
struct Blocks {
  std::span<const std::uint16_t> targets;
  const double* packed = nullptr;  ///< one after the other, packed_size(layout) each
};

/// The arena of one search: nodes and blocks in flat arrays sized at construction, no pointers
/// chased, nothing freed until clear(). 48 bytes a node; blocks only for nodes that were expanded
/// or compared. Memory is taken as it is first used, unless prefault() takes all of it.
class Tree {
 public:
  Tree(std::size_t nodes_max, std::size_t block_doubles_max);

  /// Commits every page, so that no page fault comes during a search.
  void prefault();

  void clear();
  /// kNoNode when the arena is full.
  NodeId add(const Node& node) {
    if (node_count_ == nodes_.size()) {
      return kNoNode;
    }
    nodes_[node_count_] = node;
    return static_cast<NodeId>(node_count_++);
  }
  Node& operator[](NodeId id) { return nodes_[id]; }
  const Node& operator[](NodeId id) const { return nodes_[id]; }

  /// Keeps a copy of a node's blocks. False when the arena is full.
  bool keep_posterior(NodeId id, std::span<const std::uint16_t> targets,
                      std::span<const double> packed);
  /// Room to write the blocks of a node in place, as at most so many targets and doubles; null
  /// where the arena is full. Nothing is kept until commit_posterior() follows.
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
  /// Bytes in use by nodes and blocks.
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
