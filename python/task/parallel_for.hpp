#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace vantage::python {

/// Thread pool that distributes the indices of a loop. The calling thread also processes indices.
class ParallelFor {
 public:
  /// @param threads number of threads including the calling one, ≥ 1
  explicit ParallelFor(int threads);
  ~ParallelFor();
  ParallelFor(const ParallelFor&) = delete;
  ParallelFor& operator=(const ParallelFor&) = delete;
  ParallelFor(ParallelFor&&) = delete;
  ParallelFor& operator=(ParallelFor&&) = delete;

  /// Calls body(i) once for each i < count, in any order and on any of the threads. Rethrows the
  /// first exception at the end. Must not be called by two threads simultaneously.
  void run(std::size_t count, const std::function<void(std::size_t)>& body);

 private:
  void work();
  /// Processes indices until all are done. `lock` is locked at the call and on return.
  void share(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable started_;
  std::condition_variable ended_;
  const std::function<void(std::size_t)>* body_ = nullptr;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  std::size_t piece_size_ = 1;  ///< number of indices that a thread takes at a time
  std::size_t working_ = 0;     ///< number of threads within share()
  std::exception_ptr thrown_;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace vantage::python
