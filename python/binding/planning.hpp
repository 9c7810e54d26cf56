#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "core/check.hpp"
#include "planner/problem/problem.hpp"
#include "python/binding/bind.hpp"
#include "tools/plan/problem_json.hpp"
#include "tools/plan/solver.hpp"

namespace vantage::python {

/// Mutex that throws instead of deadlocking if the thread that holds it locks it again. This
/// happens when a signal handler interrupts the work of an object and then uses this object.
class WorkMutex {
 public:
  /// Locks the mutex. @throws UsageError in the thread that already holds the mutex
  void lock() {
    require(holder_ != std::this_thread::get_id(),
            "a signal handler must not use the object on which its thread is working");
    mutex_.lock();
    holder_ = std::this_thread::get_id();
  }
  void unlock() {
    holder_ = std::thread::id();
    mutex_.unlock();
  }

 private:
  std::mutex mutex_;
  std::atomic<std::thread::id> holder_;
};

/// C++ object behind Python's vantage.Problem: a problem and the mutex that protects it.
class Problem {
 public:
  Problem(tools::PlanningProblem planning, std::string source)
      : planning_(std::move(planning)), source_(std::move(source)) {}

  /// Calls `action` with exclusive access to the problem, without the interpreter's lock.
  template <class Action>
  auto exclusively(const Action& action) const {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return action(planning_);
  }
  /// Changes the problem by `action`. @throws UsageError if the result violates a rule; the problem
  /// is then unchanged.
  template <class Action>
  void change(const Action& action) {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    const planner::SearchProblem before = planning_.problem;
    action(planning_.problem);
    try {
      planner::require_valid(planning_.problem);
      const Pose2& start = planning_.problem.start;
      require(models::clearance_m(*planning_.world, start.position_m()) > 0.0,
              "start: must be inside the map, outside every obstacle, and not on an edge of the "
              "map or of an obstacle");
    } catch (...) {
      planning_.problem = before;
      throw;
    }
  }
  [[nodiscard]] const std::string& source() const { return source_; }

 private:
  mutable WorkMutex mutex_;
  tools::PlanningProblem planning_;
  std::string source_;
};

/// C++ object behind Python's vantage.Planner: a search with its memory, which solves one problem
/// at a time. Its functions are called without the interpreter's lock.
class Planner {
 public:
  explicit Planner(const tools::PlanRequest& request) : solver_(request) {}

  /// Returns the result at the deadline, or earlier if an Interruption of the calling thread
  /// occurs.
  tools::PlanOutcome solve(const planner::SearchProblem& problem);
  void prepare(const planner::SearchProblem& problem);

 private:
  WorkMutex mutex_;
  tools::Solver solver_;
};

}  // namespace vantage::python
