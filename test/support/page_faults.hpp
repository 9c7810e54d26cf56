#pragma once

#include <sys/resource.h>

namespace vantage::test {

/// Counts the page faults of this thread since construction.
class PageFaultCounter {
 public:
  PageFaultCounter() : start_(so_far()) {}
  [[nodiscard]] long count() const { return so_far() - start_; }

 private:
  static long so_far() {
    rusage usage{};
    ::getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_minflt + usage.ru_majflt;
  }
  long start_;
};

}  // namespace vantage::test
