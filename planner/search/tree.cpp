#include "planner/search/tree.hpp"

#include <algorithm>

namespace vantage::planner {

Tree::Tree(std::size_t nodes_max, std::size_t block_doubles_max)
    : nodes_(nodes_max),
      records_(nodes_max + 1),
      targets_(block_doubles_max / 3 + 1),
      doubles_(block_doubles_max) {}

void Tree::prefault() {
  nodes_.prefault();
  records_.prefault();
  targets_.prefault();
  doubles_.prefault();
}

void Tree::clear() {
  node_count_ = 0;
  record_count_ = 1;
  target_count_ = 0;
  double_count_ = 0;
}

Tree::Room Tree::room_for_posterior(std::size_t targets_max, std::size_t doubles_max) {
  if (record_count_ == records_.size() || target_count_ + targets_max > targets_.size() ||
      double_count_ + doubles_max > doubles_.size()) {
    return {};
  }
  return {targets_.data() + target_count_, doubles_.data() + double_count_};
}

void Tree::commit_posterior(NodeId id, std::size_t targets, std::size_t doubles) {
  records_[record_count_] = {static_cast<std::uint32_t>(target_count_),
                             static_cast<std::uint32_t>(double_count_),
                             static_cast<std::uint32_t>(targets)};
  target_count_ += targets;
  double_count_ += doubles;
  nodes_[id].posterior = static_cast<std::uint32_t>(record_count_++);
}

bool Tree::keep_posterior(NodeId id, std::span<const std::uint16_t> targets,
                          std::span<const double> packed) {
  const Room room = room_for_posterior(targets.size(), packed.size());
  if (room.targets == nullptr) {
    return false;
  }
  std::copy(targets.begin(), targets.end(), room.targets);
  std::copy(packed.begin(), packed.end(), room.packed);
  commit_posterior(id, targets.size(), packed.size());
  return true;
}

Blocks Tree::posterior(NodeId id) const {
  const Record& record = records_[nodes_[id].posterior];
  return {{targets_.data() + record.targets, record.count}, doubles_.data() + record.doubles};
}

std::size_t Tree::bytes_used() const {
  return node_count_ * sizeof(Node) + record_count_ * sizeof(Record) +
         target_count_ * sizeof(std::uint16_t) + double_count_ * sizeof(double);
}

}  // namespace vantage::planner
