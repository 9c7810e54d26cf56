#pragma once

#include <cstddef>

namespace vantage::test {

/// Counts the heap allocations of this thread since construction (malloc, calloc, realloc, new).
///
///   AllocationCounter allocations;
///   filter.predict(now, twist);
///   EXPECT_EQ(allocations.count(), 0u);
///
/// Interposes glibc's allocator, so it is inert under the sanitizers: see is_active().
class AllocationCounter {
 public:
  AllocationCounter();
  [[nodiscard]] std::size_t count() const;
  static bool is_active();

 private:
  std::size_t start_;
};

}  // namespace vantage::test
