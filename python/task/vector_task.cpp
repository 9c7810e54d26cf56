#include "python/task/vector_task.hpp"

#include <fmt/format.h>

#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::python {

std::uint64_t next_episode_seed(std::uint64_t seed) {
  return sim::random_stream(seed, "next episode")();
}

VectorTask::VectorTask(int count, int threads, const Make& make) : parallel_(threads) {
  constexpr int kCountMax = 1 << 20;
  require(count >= 1 && count <= kCountMax,
          fmt::format("count: must be ≥ 1 and ≤ {}, got {}", kCountMax, count));
  for (int i = 0; i < count; ++i) {
    tasks_.push_back(make());
  }
  seeds_.assign(tasks_.size(), 0);
}

void VectorTask::reset(std::span<const std::uint64_t> seeds) {
  require(
      seeds.size() == tasks_.size(),
      fmt::format("seeds: must have one seed per task ({}), got {}", tasks_.size(), seeds.size()));
  seeds_.assign(seeds.begin(), seeds.end());
  parallel_.run(tasks_.size(), [&](std::size_t i) { tasks_[i]->reset(seeds_[i]); });
  was_reset_ = true;
}

void VectorTask::step(std::span<const std::int64_t> actions, std::span<double> rewards,
                      std::span<bool> is_over) {
  require(was_reset_, "reset() must be called before the first step()");
  require_actions(actions, tasks_.size(), *tasks_.front());
  const auto robots = static_cast<std::size_t>(tasks_.front()->robots());
  parallel_.run(tasks_.size(), [&](std::size_t i) {
    TeamTask& task = *tasks_[i];
    if (task.is_over()) {
      seeds_[i] = next_episode_seed(seeds_[i]);
      task.reset(seeds_[i]);
      rewards[i] = 0.0;
    } else {
      rewards[i] = task.step(actions.subspan(i * robots, robots));
    }
    is_over[i] = task.is_over();
  });
}

void VectorTask::observe(std::span<float> out) {
  require(was_reset_, "reset() must be called before the first observation");
  const auto size = static_cast<std::size_t>(tasks_.front()->robots()) *
                    static_cast<std::size_t>(tasks_.front()->observation_size());
  parallel_.run(tasks_.size(),
                [&](std::size_t i) { tasks_[i]->observe(out.subspan(i * size, size)); });
}

}  // namespace vantage::python
