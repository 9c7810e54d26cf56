#include "python/task/parallel_for.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::python {

ParallelFor::ParallelFor(int threads) {
  constexpr int kThreadsMax = 256;
  require(threads >= 1 && threads <= kThreadsMax,
          fmt::format("threads: must be ≥ 1 and ≤ {}, got {}", kThreadsMax, threads));
  for (int i = 1; i < threads; ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

ParallelFor::~ParallelFor() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  started_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void ParallelFor::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    started_.wait(lock, [&] { return is_ending_ || next_ < count_; });
    if (is_ending_) {
      return;
    }
    share(lock);
    if (working_ == 0) {
      ended_.notify_one();
    }
  }
}

void ParallelFor::share(std::unique_lock<std::mutex>& lock) {
  ++working_;
  while (next_ < count_) {
    const std::size_t begin = next_;
    const std::size_t end = std::min(count_, begin + piece_size_);
    next_ = end;
    lock.unlock();
    std::exception_ptr thrown;
    try {
      for (std::size_t i = begin; i < end; ++i) {
        (*body_)(i);
      }
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
    if (thrown && !thrown_) {
      thrown_ = thrown;
    }
  }
  --working_;
}

void ParallelFor::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  // number of pieces per thread; several, so that a slow piece delays the end only a little
  constexpr std::size_t kPiecesEach = 4;
  std::unique_lock lock(mutex_);
  body_ = &body;
  count_ = count;
  next_ = 0;
  piece_size_ = std::max<std::size_t>(1, count / (kPiecesEach * (threads_.size() + 1)));
  thrown_ = nullptr;
  if (!threads_.empty() && count > 1) {
    started_.notify_all();
  }
  share(lock);
  ended_.wait(lock, [&] { return working_ == 0; });
  if (thrown_) {
    std::rethrow_exception(std::exchange(thrown_, nullptr));
  }
}

}  // namespace vantage::python
