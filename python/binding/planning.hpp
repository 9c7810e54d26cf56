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

/// A mutex that refuses, rather than wait for itself, the thread that holds it: a signal's handler
/// that asks for what was interrupted.
class WorkMutex {
 public:
  /// @throws UsageError in the thread that holds it
  void lock() {
    require(holder_ != std::this_thread::get_id(),
            "what this thread is at work on may not be used by a signal's handler");
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

/// What Python's vantage.Problem holds: a problem and who is at work on it.
class Problem {
 public:
  Problem(tools::PlanningProblem planning, std::string source)
      : planning_(std::move(planning)), source_(std::move(source)) {}

  /// Calls `action` with the problem to itself, without the interpreter's lock.
  template <class Action>
  auto alone(const Action& action) const {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return action(planning_);
  }
  /// Lets `action` change the problem. @throws UsageError when it then breaks a rule: it has not
  /// changed.
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
              "start: must be inside the map and outside every obstacle, touching neither");
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

/// What Python's vantage.Planner holds: a search with its memory, one problem at a time. Called
/// without the interpreter's lock.
class Planner {
 public:
  explicit Planner(const tools::PlanRequest& request) : solver_(request) {}

  /// By the deadline, or sooner when an Interruption of the calling thread comes.
  tools::PlanOutcome solve(const planner::SearchProblem& problem);
  void prepare(const planner::SearchProblem& problem);

 private:
  WorkMutex mutex_;
  tools::Solver solver_;
};

}  // namespace vantage::python
