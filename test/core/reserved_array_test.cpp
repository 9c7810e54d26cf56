#include "core/reserved_array.hpp"

#include <algorithm>
#include <cstdint>
#include <new>

#include <gtest/gtest.h>
#include <sys/prctl.h>

namespace vantage {
namespace {

constexpr std::size_t kMany = std::size_t{1} << 24;

TEST(ReservedArray, IsZeroInitialisedAndKeepsWrites) {
  ReservedArray<double> values(1000);
  EXPECT_EQ(values.size(), 1000U);
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; }));
  values[999] = 3.5;
  EXPECT_EQ(values[999], 3.5);
}

/// Turns off huge pages, which the system may commit as a whole, for the life of this object.
class SmallPages {
 public:
  SmallPages() { ::prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0); }
  ~SmallPages() { ::prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0); }
  SmallPages(const SmallPages&) = delete;
  SmallPages& operator=(const SmallPages&) = delete;
  SmallPages(SmallPages&&) = delete;
  SmallPages& operator=(SmallPages&&) = delete;
};

TEST(ReservedArray, CommitsOnlyWrittenPages) {
  const SmallPages pages;
  ReservedArray<std::uint64_t> values(kMany);
  EXPECT_EQ(values.committed_bytes(), 0U);
  values[0] = 1;
  values[kMany - 1] = 1;
  EXPECT_GT(values.committed_bytes(), 0U);
  EXPECT_LE(values.committed_bytes(), std::size_t{1} << 17U);  // two pages of at most 64 KiB
}

TEST(ReservedArray, PrefaultCommitsAllPagesOfASmallArray) {
  ReservedArray<std::uint32_t> values(200'000);
  values[0] = 7;
  values[1024] = 8;
  values.prefault();
  EXPECT_GE(values.committed_bytes(), values.size() * sizeof(std::uint32_t));
  EXPECT_EQ(values[0], 7U);
  EXPECT_EQ(values[1024], 8U);
  EXPECT_EQ(values[199'999], 0U);
}

TEST(ReservedArray, PrefaultCommitsOnlyTheBeginningOfALargeArray) {
  const SmallPages pages;
  constexpr std::size_t kMiB = std::size_t{1} << 20U;
  ReservedArray<std::uint8_t> values(64 * kMiB);
  values.prefault();
  EXPECT_EQ(values.committed_bytes(), kMiB);
}

TEST(ReservedArray, MovesAndSwaps) {
  ReservedArray<int> a(10);
  a[3] = 3;
  ReservedArray<int> b = std::move(a);
  EXPECT_EQ(b.size(), 10U);
  EXPECT_EQ(b[3], 3);
  ReservedArray<int> c(20);
  std::swap(b, c);
  EXPECT_EQ(b.size(), 20U);
  EXPECT_EQ(c[3], 3);
}

TEST(ReservedArray, IsEmptyWithSizeZero) {
  ReservedArray<int> none(0);
  none.prefault();
  EXPECT_EQ(none.begin(), none.end());
  EXPECT_EQ(none.committed_bytes(), 0U);
}

TEST(ReservedArray, RefusesMoreThanTheAddressSpace) {
  EXPECT_THROW(ReservedBytes(std::size_t{1} << 62), std::bad_alloc);
}

}  // namespace
}  // namespace vantage
