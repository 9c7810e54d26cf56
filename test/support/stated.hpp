#pragma once

#include <span>

#include <gtest/gtest.h>

namespace vantage::test {

/// A number that a document states.
struct Stated {
  const char* name;
  double value;
  double stated;
};

inline void expect_as_stated(std::span<const Stated> rows) {
  for (const Stated& row : rows) {
    EXPECT_EQ(row.value, row.stated) << row.name;
  }
}

}  // namespace vantage::test
