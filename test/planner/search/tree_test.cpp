#include "planner/search/tree.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "planner/search/node_list.hpp"
#include "planner/search/plan_path.hpp"

namespace vantage::planner {
namespace {

Node node(NodeId parent, int control, int depth, double x_m) {
  Node out;
  out.world_from_body = {x_m, -x_m, 0.1 * depth};
  out.parent = parent;
  out.control = static_cast<std::int16_t>(control);
  out.depth = static_cast<std::uint8_t>(depth);
  return out;
}

TEST(Tree, HasTheStatedNodeCapacity) {
  Tree tree(3, 30);
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(tree.node_count(), 0U);
    for (NodeId id = 0; id < 3; ++id) {
      EXPECT_EQ(tree.add(node(kNoNode, 0, 0, id)), id);
    }
    EXPECT_EQ(tree.add(node(kNoNode, 0, 0, 9.0)), kNoNode);
    EXPECT_EQ(tree.node_count(), 3U);
    EXPECT_EQ(tree[2].world_from_body.x_m, 2.0);
    tree.clear();
  }
}

// Blocks of successive nodes do not overlap, and the last number of the memory is usable.
TEST(Tree, KeepsTheBlocksOfEachNode) {
  constexpr std::size_t kDoubles = 30;
  Tree tree(4, kDoubles);
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::vector<std::uint16_t>> targets{{2, 5}, {}, {1}, {0, 3, 4}};
    const std::vector<std::size_t> doubles{6, 0, 10, 14};  // 30 in total
    double next = 1.0;
    std::vector<std::vector<double>> packed;
    for (std::size_t i = 0; i < 4; ++i) {
      const NodeId id = tree.add(node(kNoNode, 0, 0, 0.0));
      EXPECT_FALSE(tree.has_posterior(id));
      packed.emplace_back(doubles[i]);
      std::generate(packed[i].begin(), packed[i].end(), [&] { return next++; });
      if (i == 3) {  // one number too many
        EXPECT_EQ(tree.room_for_posterior(3, doubles[i] + 1).targets, nullptr);
        EXPECT_NE(tree.room_for_posterior(3, doubles[i]).targets, nullptr);
      }
      EXPECT_TRUE(tree.keep_posterior(id, targets[i], packed[i]));
      EXPECT_TRUE(tree.has_posterior(id));
    }
    for (NodeId id = 0; id < 4; ++id) {
      const Blocks blocks = tree.posterior(id);
      EXPECT_TRUE(std::equal(blocks.targets.begin(), blocks.targets.end(), targets[id].begin(),
                             targets[id].end()));
      EXPECT_TRUE(std::equal(packed[id].begin(), packed[id].end(), blocks.packed));
    }
    // Sum of nodes, one record of three numbers per node, targets and doubles.
    EXPECT_EQ(tree.bytes_used(), 4 * sizeof(Node) + 5 * 12 + 6 * 2 + kDoubles * 8);
    const double one[] = {0.0};
    EXPECT_FALSE(tree.keep_posterior(0, {}, {}));  // one record per node, and all are used
    EXPECT_FALSE(tree.keep_posterior(0, {}, one));
    tree.clear();
    EXPECT_EQ(tree.bytes_used(), std::size_t{12});
  }
}

TEST(Tree, HasTheStatedBlockCapacity) {
  Tree tree(10, 6);
  EXPECT_NE(tree.room_for_posterior(3, 6).targets, nullptr);
  EXPECT_EQ(tree.room_for_posterior(4, 6).targets, nullptr);
  EXPECT_EQ(tree.room_for_posterior(3, 7).targets, nullptr);
}

TEST(NodeList, IsAQueue) {
  Tree tree(5, 3);
  for (int i = 0; i < 5; ++i) {
    tree.add(node(kNoNode, 0, 0, i));
  }
  NodeList list;
  NodeList other;
  EXPECT_TRUE(list.is_empty());
  list.push(tree, 3);
  list.push(tree, 0);
  other.push(tree, 1);
  list.push(tree, 4);
  EXPECT_EQ(list.pop(tree), 3U);
  list.push(tree, 3);
  EXPECT_EQ(list.pop(tree), 0U);
  EXPECT_EQ(list.pop(tree), 4U);
  EXPECT_EQ(list.pop(tree), 3U);
  EXPECT_TRUE(list.is_empty());
  EXPECT_EQ(list.first, kNoNode);
  list.push(tree, 2);
  EXPECT_EQ(list.first, 2U);
  EXPECT_EQ(list.last, 2U);
  EXPECT_EQ(other.pop(tree), 1U);
}

// The result is the path from the root and then a hover until the horizon. An earlier result is
// overwritten.
TEST(WritePath, WritesThePathFromTheRootAndAHover) {
  Tree tree(8, 3);
  tree.add(node(kNoNode, -1, 0, 0.0));
  tree.add(node(0, 3, 1, 1.0));
  tree.add(node(0, 4, 1, -1.0));
  tree.add(node(1, 5, 2, 2.0));
  SearchResult result;
  result.controls = {9, 9, 9, 9, 9, 9};
  result.cost = 7.0;
  write_path(tree, 3, 5, result);
  EXPECT_TRUE(result.found);
  EXPECT_EQ(result.controls, (std::vector<int>{3, 5}));
  EXPECT_EQ(result.moving_steps, 2);
  ASSERT_EQ(result.poses.size(), 5U);
  EXPECT_EQ(result.poses[0], tree[1].world_from_body);
  for (std::size_t t = 1; t < 5; ++t) {
    EXPECT_EQ(result.poses[t], tree[3].world_from_body);
  }
  EXPECT_EQ(result.cost, 7.0);

  const Pose2 leaf{4.0, 5.0, 6.0};
  write_path(tree, 3, 8, leaf, result);
  EXPECT_EQ(result.controls, (std::vector<int>{3, 5, 8}));
  EXPECT_EQ(result.moving_steps, 3);
  EXPECT_EQ(result.poses,
            (std::vector<Pose2>{tree[1].world_from_body, tree[3].world_from_body, leaf}));

  write_path(tree, 0, 2, result);  // hovers from the start
  EXPECT_TRUE(result.controls.empty());
  EXPECT_EQ(result.moving_steps, 0);
  EXPECT_EQ(result.poses, (std::vector<Pose2>(2, tree[0].world_from_body)));
}

}  // namespace
}  // namespace vantage::planner
