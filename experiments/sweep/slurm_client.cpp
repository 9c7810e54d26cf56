#include "experiments/sweep/slurm_client.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/check.hpp"
#include "core/child.hpp"
#include "experiments/sweep/slurm_job.hpp"

namespace vantage::experiments {
namespace {

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) {
    text.pop_back();
  }
  return text;
}

std::vector<std::string> joined(std::vector<std::string> words,
                                const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

template <class Rule>
auto count_of(const SlurmQueue& queue, const Rule& rule) {
  return std::count_if(queue.tasks.begin(), queue.tasks.end(),
                       [&](const auto& task) { return rule(task.second); });
}

}  // namespace

std::string SlurmJobs::subject_and_verb() const {
  return collector.empty()
             ? fmt::format("job {} is", job_text(array))
             : fmt::format("jobs {} and {} are", number_of(array), job_text(collector));
}

bool SlurmQueue::has_task(bool (*rule)(const std::string& state)) const {
  return count_of(*this, rule) > 0;
}

std::string SlurmQueue::describe() const {
  const auto running = count_of(*this, [](const std::string& state) { return state == "RUNNING"; });
  return fmt::format("tasks: {} running, {} waiting", running, count_of(*this, is_live) - running);
}

std::string submit_job(const std::vector<std::string>& options, const std::string& script) {
  const Result<CommandOutput> answer =
      run_command(joined(joined({"sbatch", "--parsable"}, options), {script}));
  if (!answer.ok()) {
    throw StartupError(answer.error().message +
                       "; run --slurm on a machine that can submit jobs to a cluster");
  }
  const std::string job = job_of(answer.value().text);
  if (!answer.value().exit.is_success() || job.empty()) {
    throw StartupError("Slurm rejected the job: " + trimmed(answer.value().text));
  }
  return job;
}

Result<SlurmQueue> query_queue(const SlurmJobs& jobs) {
  const std::string array = number_of(jobs.array);
  const std::string collector = number_of(jobs.collector);
  const Result<CommandOutput> answer =
      run_command(joined({"squeue", "--noheader", "--array", "--states=all", "--format=%i|%T",
                          "--jobs=" + array + (collector.empty() ? "" : "," + collector)},
                         cluster_option(jobs.array)));
  if (!answer.ok()) {
    return answer.error();
  }
  const std::string& text = answer.value().text;
  const bool is_forgotten = text.find("Invalid job id") != std::string::npos;
  if (!answer.value().exit.is_success() && !is_forgotten) {
    return Error{trimmed(text)};
  }
  SlurmQueue queue;
  for (const auto& [job, state] : states_of(text)) {
    const std::size_t underscore = job.find('_');
    if (job == collector) {
      queue.collector = state;
    } else if (underscore != std::string::npos && job.substr(0, underscore) == array) {
      queue.tasks[std::atoi(job.c_str() + underscore + 1)] = state;
    }
  }
  return queue;
}

void cancel_job(const std::string& job, const std::vector<std::string>& options) {
  if (job.empty()) {
    return;
  }
  static_cast<void>(run_command(joined(
      joined(joined({"scancel", "--quiet"}, options), cluster_option(job)), {number_of(job)})));
}

std::string cancel_command(const SlurmJobs& jobs) {
  auto words = joined(joined({"scancel"}, cluster_option(jobs.array)), {number_of(jobs.array)});
  if (!jobs.collector.empty()) {
    words.push_back(number_of(jobs.collector));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace vantage::experiments
