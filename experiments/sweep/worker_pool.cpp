#include "experiments/sweep/worker_pool.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace vantage::experiments {
namespace {

constexpr std::chrono::milliseconds kTickPeriod{200};

class Pool {
 public:
  Pool(const std::vector<Unit>& units, const PoolOptions& options,
       const std::function<UnitRows(const Unit&)>& work,
       const std::function<void(const Unit&, UnitRows)>& keep)
      : units_(units), options_(options), work_(work), keep_(keep), running_(options.jobs) {}

  void run() {
    std::vector<std::jthread> threads;
    for (int job = 0; job < options_.jobs; ++job) {
      threads.emplace_back([this] { serve(); });
    }
    std::unique_lock lock(mutex_);
    while (!ended_.wait_for(lock, kTickPeriod, [this] { return running_ == 0; })) {
      if (options_.tick) {
        options_.tick();
      }
    }
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

 private:
  void serve() {
    std::unique_lock lock(mutex_);
    while (next_ < units_.size() && !failure_ && !(options_.stop && options_.stop())) {
      const Unit unit = units_[next_++];
      lock.unlock();
      UnitRows rows;
      std::exception_ptr failure;
      try {
        rows = work_(unit);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      try {
        if (failure) {
          std::rethrow_exception(failure);
        }
        keep_(unit, std::move(rows));
      } catch (...) {
        failure_ = std::current_exception();
      }
    }
    --running_;
    ended_.notify_one();
  }

  const std::vector<Unit>& units_;
  const PoolOptions& options_;
  const std::function<UnitRows(const Unit&)>& work_;
  const std::function<void(const Unit&, UnitRows)>& keep_;
  std::mutex mutex_;  ///< guards all members below; held while keep_ is called
  std::condition_variable ended_;
  std::size_t next_ = 0;
  int running_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void run_units(const std::vector<Unit>& units, const PoolOptions& options,
               const std::function<UnitRows(const Unit&)>& work,
               const std::function<void(const Unit&, UnitRows)>& keep) {
  Pool(units, options, work, keep).run();
}

}  // namespace vantage::experiments
