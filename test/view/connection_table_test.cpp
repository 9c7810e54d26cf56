#include "tools/view/connection_table.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using Peer = ConnectionTable::Peer;
using Peers = std::vector<Peer>;
using std::chrono::milliseconds;

constexpr Time kStart = from_utime(1'000'000);
constexpr const char* kOne = "10.0.0.1";

TEST(ConnectionTable, EndsConnectionWithoutRequest) {
  ConnectionTable table;
  const std::set<Peer> open{{kOne, 1}, {kOne, 2}, {kOne, 3}};
  EXPECT_TRUE(table.update(open, kStart).empty());
  table.on_request({kOne, 1}, kStart);
  table.on_viewer({kOne, 2}, kStart);
  EXPECT_TRUE(table.update(open, kStart + ConnectionTable::kHeaderPatience).empty());
  const Time late = kStart + ConnectionTable::kHeaderPatience + Duration{1};
  EXPECT_EQ(table.update(open, late), (Peers{{kOne, 3}}));
  EXPECT_TRUE(table.update(open, late + std::chrono::hours(1)).empty());
  EXPECT_TRUE(table.update({}, late).empty());
  EXPECT_TRUE(table.update(open, late).empty()) << "new connections with the same ports";
}

TEST(ConnectionTable, ClosesTheOldestConnectionOfAnAddress) {
  ConnectionTable table;
  std::set<Peer> open{{"10.0.0.2", 1}};
  for (int port = 100; port > 68; --port) {
    open.insert({kOne, port});
    EXPECT_TRUE(table.update(open, kStart + milliseconds(100 - port)).empty());
  }
  open.insert({kOne, 1});
  open.insert({kOne, 2});
  EXPECT_EQ(table.update(open, kStart + milliseconds(40)), (Peers{{kOne, 100}, {kOne, 99}}));
  table.on_viewer({kOne, 98}, kStart);
  open.insert({kOne, 3});
  EXPECT_TRUE(table.update(open, kStart + milliseconds(50)).empty()) << "a viewer is not counted";
}

// Three addresses have 30 or 20 connections each: below the limit per address, but together the
// total limit.
TEST(ConnectionTable, EndsOldestOfBusiestAddressAtTotalLimit) {
  ConnectionTable table;
  std::set<Peer> open;
  const auto add = [&](const char* address, int first, int count, int at_ms) {
    for (int port = first; port < first + count; ++port) {
      open.insert({address, port});
    }
    return table.update(open, kStart + milliseconds(at_ms));
  };
  EXPECT_TRUE(add(kOne, 1, 1, 0).empty());
  EXPECT_TRUE(add(kOne, 2, 30, 1).empty());
  EXPECT_TRUE(add("10.0.0.2", 1, 30, 2).empty());
  EXPECT_TRUE(add("10.0.0.3", 1, 19, 3).empty());
  EXPECT_EQ(add("10.0.0.4", 1, 1, 4), (Peers{{kOne, 1}}));
}

}  // namespace
}  // namespace vantage::tools
