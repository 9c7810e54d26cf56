#include "core/cpu_time.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace vantage {
namespace {

TEST(ThreadCpu, MeasuresThisThreadOnly) {
  constexpr std::int64_t kWork_ns = 20'000'000;
  const std::int64_t begin_ns = thread_cpu_ns();
  std::thread([&] {
    const std::int64_t end_ns = thread_cpu_ns() + kWork_ns;
    while (thread_cpu_ns() < end_ns) {
    }
    EXPECT_GE(thread_cpu_s(), 1e-9 * static_cast<double>(end_ns));
  }).join();
  EXPECT_LT(thread_cpu_ns() - begin_ns, kWork_ns);
}

}  // namespace
}  // namespace vantage
