#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "python/task/parallel_for.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// Many tasks of one kind, stepped together on several threads. What each does is a pure function
/// of its seed and its actions, however many threads there are.
class VectorTask {
 public:
  using Make = std::function<std::unique_ptr<TeamTask>()>;
  /// @throws UsageError for a count or threads below 1, and what `make` throws.
  VectorTask(int count, int threads, const Make& make);

  /// Begins all again, each by its own seed.
  void reset(std::span<const std::uint64_t> seeds);
  /// Steps all. A task whose episode was over begins its next one instead: its actions are ignored,
  /// its reward is 0. The next episode's seed follows from the one before.
  /// @param actions  [task][robot]; what is wrong with one is found before anything moves
  /// @param rewards, is_over  one a task
  void step(std::span<const std::int64_t> actions, std::span<double> rewards,
            std::span<bool> is_over);
  /// Observations of all: [task][robot][entry].
  void observe(std::span<float> out);

  [[nodiscard]] std::size_t size() const { return tasks_.size(); }
  [[nodiscard]] const TeamTask& task(std::size_t index) const { return *tasks_[index]; }

 private:
  std::vector<std::unique_ptr<TeamTask>> tasks_;
  std::vector<std::uint64_t> seeds_;  ///< of the present episodes
  bool was_reset_ = false;
  ParallelFor parallel_;
};

/// The seed of the episode after that of `seed`.
std::uint64_t next_episode_seed(std::uint64_t seed);

}  // namespace vantage::python
