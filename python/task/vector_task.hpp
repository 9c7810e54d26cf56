#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "python/task/parallel_for.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// Tasks of one kind that are stepped simultaneously on several threads. The result of each task
/// depends only on its seed and its actions, not on the number of threads.
class VectorTask {
 public:
  using Make = std::function<std::unique_ptr<TeamTask>()>;
  /// @throws UsageError for a count or threads below 1, and any exception of `make`.
  VectorTask(int count, int threads, const Make& make);

  /// Starts new episodes of all tasks, each with its own seed.
  void reset(std::span<const std::uint64_t> seeds);
  /// Steps all tasks. A task with an episode that is over starts its next episode instead: its
  /// actions are ignored and its reward is 0. next_episode_seed() gives the next seed.
  /// @param actions [task][robot]; all are checked before the first task is stepped
  /// @param rewards, is_over  one per task
  void step(std::span<const std::int64_t> actions, std::span<double> rewards,
            std::span<bool> is_over);
  /// Writes the observations of all tasks as [task][robot][entry].
  void observe(std::span<float> out);

  [[nodiscard]] std::size_t size() const { return tasks_.size(); }
  [[nodiscard]] bool was_reset() const { return was_reset_; }
  [[nodiscard]] const TeamTask& task(std::size_t index) const { return *tasks_[index]; }

 private:
  std::vector<std::unique_ptr<TeamTask>> tasks_;
  std::vector<std::uint64_t> seeds_;  ///< seeds of the current episodes
  bool was_reset_ = false;
  ParallelFor parallel_;
};

/// Returns the seed of the episode that follows the episode with `seed`.
std::uint64_t next_episode_seed(std::uint64_t seed);

}  // namespace vantage::python
