#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_compact.hpp"

namespace vantage::bus {
namespace {

models::CompactBelief small_belief() {
  models::CompactBelief belief;
  belief.stamp = {from_utime(1'000'000'000), 2, 3};
  belief.robot = "Q1";
  belief.step = 4;
  belief.viewpoint = {{1.0, 2.0, 0.5}, 3.0};
  models::CompactTarget target;
  target.target_id = 5;
  target.dim = 2;
  target.mean = {1.5F, -2.0F};
  target.sigma_code = {1024, -1024};
  target.correlation_code = {16'384};
  target.unseen_ms = 500;
  belief.targets = {target};
  belief.grid = {{-2.0, -1.0}, 0.5, 8, 4};
  belief.runs = {1, 2, 3};
  return belief;
}

TEST(CompactBeliefBytes, HaveTheDocumentedSize) {
  // fingerprint, stamp, name, step, pose, one target of 2 dimensions, grid, runs
  EXPECT_EQ(test::encoded(small_belief()).size(),
            8U + 24 + (4 + 3) + 8 + 32 + 4 + (4 + 1 + 8 + 4 + 1 + 2 + 4) + 24 + 8 + (4 + 3));
}

// The bytes of one target, from the position after the fixed fields.
TEST(CompactBeliefBytes, FollowTheDocumentedLayout) {
  const std::vector<std::uint8_t> bytes = test::encoded(small_belief());
  const std::vector<std::uint8_t> target(bytes.begin() + 83, bytes.begin() + 107);
  EXPECT_EQ(target, (std::vector<std::uint8_t>{0,    0,    0,    5,                   // id
                                               2,                                     // dimension
                                               0x3F, 0xC0, 0,    0,   0xC0, 0, 0, 0,  // mean
                                               4,    0,    0xFC, 0,                   // sigma
                                               1,    0x40, 0,              // correlations
                                               0,    0,    1,    0xF4}));  // age
}

struct SpoiledRow {
  const char* what;
  void (*spoil)(vantage_lcm::compact_belief_t&);
};

TEST(CompactBelief, RefusesImpossibleValues) {
  const SpoiledRow rows[] = {
      {"target id", [](auto& w) { w.targets[0].target_id = -1; }},
      {"dimension", [](auto& w) { w.targets[0].dim = 1; }},
      {"correlations", [](auto& w) { w.targets[0].num_correlations = 3; }},
      {"count of targets", [](auto& w) { w.num_targets = 2; }},
      {"count of run bytes", [](auto& w) { w.num_run_bytes = 2; }},
      {"runs",
       [](auto& w) {
         w.runs = {30, 2, 3, 1}, w.num_run_bytes = 4;
       }},
      {"runs beyond the grid",
       [](auto& w) {
         w.runs = {31, 2, 3};
       }},
      {"grid", [](auto& w) { w.grid_columns = 2'000'000; }},
      {"resolution", [](auto& w) { w.grid_resolution_m = 0.0; }},
      {"correlation of 1", [](auto& w) { w.targets[0].correlation_code[0] = 32'767; }},
      {"cells before 1970", [](auto& w) { w.utime = 1'000'000; }},
      {"step", [](auto& w) { w.step = -1; }}};
  const auto good = to_wire(small_belief());
  ASSERT_TRUE(from_wire(good));
  for (const SpoiledRow& row : rows) {
    auto bad = good;
    row.spoil(bad);
    EXPECT_FALSE(from_wire(bad)) << row.what;
  }
}

// Random changes of single bytes give a refusal or a valid belief.
TEST(CompactBelief, IsRefusedOrValidWhenBytesChange) {
  test::Sampler sampler(9);
  int accepted = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> bytes = test::encoded(test::sample<models::CompactBelief>(sampler));
    for (int k = sampler.small(1, 3); k > 0; --k) {
      bytes[static_cast<std::size_t>(sampler.small(8, static_cast<int>(bytes.size()) - 1))] =
          static_cast<std::uint8_t>(sampler.small(0, 255));
    }
    const auto wire = decode_wire<vantage_lcm::compact_belief_t>(bytes);
    const auto belief = wire ? from_wire(*wire) : std::nullopt;
    accepted += belief ? 1 : 0;
    ASSERT_TRUE(!belief || models::expand(*belief));
  }
  EXPECT_GT(accepted, 1000);
}

}  // namespace
}  // namespace vantage::bus
