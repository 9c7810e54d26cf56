#include "experiments/sweep/slurm_run.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/write_file.hpp"
#include "experiments/sweep/row_files.hpp"
#include "experiments/sweep/slurm_client.hpp"
#include "experiments/sweep/slurm_job.hpp"

namespace vantage::experiments {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::string last_line_of(const fs::path& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    last = line.empty() ? last : line;
  }
  return last;
}

class SlurmRun {
 public:
  SlurmRun(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
           const SweepOptions& options, const SlurmOptions& slurm)
      : sweep_(sweep),
        identity_(identity),
        what_(what),
        options_(options),
        slurm_(slurm),
        folder_(fs::absolute(options.directory) / "slurm") {}

  SlurmEnd run() {
    claim_directory(options_.directory, identity_, sweep_.plan);
    read_submitted();
    if (!submitted_.array.empty() && is_in_queue()) {
      slurm_.print_line(
          fmt::format("{} in the queue: nothing is submitted", submitted_.subject_and_verb()));
    } else {
      const auto done = read_rows(options_.directory, sweep_.plan, identity_).done;
      const std::vector<int> incomplete = incomplete_shards(sweep_.plan, slurm_.shards, done);
      if (incomplete.empty()) {
        return collect();
      }
      submit(incomplete);
    }
    return slurm_.is_waiting ? wait() : leave_running();
  }

 private:
  SlurmEnd collect() const {
    for (const std::string& line : run_sweep(sweep_, identity_, what_, options_).lines) {
      slurm_.print_line(line);
    }
    return SlurmEnd::kCollected;
  }

  void read_submitted() {
    std::ifstream file(folder_ / "submitted.json");
    const auto json = nlohmann::json::parse(file, nullptr, false);
    if (json.is_object()) {
      submitted_ = {json.value("array", ""), json.value("collector", ""), json.value("shards", 0)};
    }
  }

  void keep_submitted() const {
    write_file(folder_ / "submitted.json", nlohmann::json{{"array", submitted_.array},
                                                          {"collector", submitted_.collector},
                                                          {"shards", submitted_.shards}}
                                                   .dump() +
                                               "\n");
  }

  [[nodiscard]] fs::path log_of(int shard) const {
    return folder_ / fmt::format("shard_{}.log", shard);
  }

  [[nodiscard]] bool is_in_queue() const {
    const Result<SlurmQueue> now = query_queue(submitted_);
    if (!now.ok()) {
      throw StartupError(fmt::format(
          "{} perhaps in the queue, but Slurm cannot be queried: {}; nothing is submitted",
          submitted_.subject_and_verb(), now.error().message));
    }
    return now.value().has_task(is_live) || is_live(now.value().collector);
  }

  // Submits a job and returns it. Uses the cluster of `near` if it is named, because a dependency
  // cannot refer to another cluster.
  [[nodiscard]] std::string sbatch(std::vector<std::string> options, const char* script,
                                   const std::string& near) const {
    options.push_back("--chdir=" + folder_.string());
    options.push_back("--job-name=vantage-" + identity_.experiment);
    options.emplace_back("--requeue");  // Slurm repeats a job after a node failure
    options.insert(options.end(), slurm_.sbatch.begin(), slurm_.sbatch.end());
    const std::vector<std::string> cluster = cluster_option(near);
    options.insert(options.end(), cluster.begin(), cluster.end());
    return submit_job(options, (folder_ / script).string());
  }

  void submit(const std::vector<int>& incomplete) {
    std::error_code error;
    fs::create_directories(folder_, error);
    const SlurmScripts scripts = slurm_scripts(slurm_.command, slurm_.shards);
    write_file(folder_ / "shards.sh", scripts.shards);
    write_file(folder_ / "collect.sh", scripts.collect);
    for (const int shard : incomplete) {
      fs::remove(log_of(shard),
                 error);  // removes an earlier job's log, which could be mistaken for the new one
    }
    submitted_ = {"", "", slurm_.shards};
    submitted_.array = sbatch({"--array=" + array_text(incomplete), "--output=shard_%a.log",
                               fmt::format("--cpus-per-task={}", slurm_.cores_per_task)},
                              "shards.sh", "");
    keep_submitted();
    try {
      submitted_.collector = sbatch({"--dependency=afterok:" + number_of(submitted_.array),
                                     "--kill-on-invalid-dep=yes", "--output=collect.log"},
                                    "collect.sh", submitted_.array);
    } catch (const StartupError& refusal) {
      cancel_job(submitted_.array);
      throw StartupError(fmt::format("{} (job that collects the results; job {} is cancelled)",
                                     refusal.what(), job_text(submitted_.array)));
    }
    keep_submitted();
    slurm_.print_line(fmt::format(
        "submitted: job {} for shards {} of {}, job {} collects their results; logs in {}",
        job_text(submitted_.array), array_text(incomplete), slurm_.shards,
        job_text(submitted_.collector), folder_.string()));
  }

  SlurmEnd leave_running() const {
    slurm_.print_line(fmt::format(
        "{} still in the queue; results will be in {}. Run the same command to wait for "
        "them. To cancel: {}",
        submitted_.subject_and_verb(), options_.directory, cancel_command(submitted_)));
    return SlurmEnd::kSubmitted;
  }

  // Waits for `time`; returns false when the caller stops the run.
  [[nodiscard]] bool pause(std::chrono::milliseconds time) const {
    const auto until = Clock::now() + time;
    while (Clock::now() < until) {
      if (options_.stop && options_.stop()) {
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return true;
  }

  SweepProgress progress_now() {
    SweepProgress progress;
    progress.units = units_of(sweep_.plan, {}).size();
    progress.done = read_rows(options_.directory, sweep_.plan, identity_).done.size();
    done_before_ = done_before_.value_or(progress.done);
    progress.done_before = *done_before_;
    progress.elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
    return progress;
  }

  // Returns a short period at the start, for short jobs, and a longer period later, to limit the
  // load on the cluster.
  [[nodiscard]] std::chrono::milliseconds poll_period() const {
    using std::chrono::milliseconds;
    return std::clamp(std::chrono::duration_cast<milliseconds>(Clock::now() - start_) / 10,
                      milliseconds(1'000), milliseconds(20'000));
  }

  SlurmEnd wait() {
    // On a network file system, rows written by a node may become visible later.
    constexpr std::chrono::seconds kSeenWithin{60};
    std::optional<Clock::time_point> ended;
    std::map<int, std::string> last;  // last known state of each task
    while (true) {
      const Result<SlurmQueue> now = query_queue(submitted_);
      const SweepProgress progress = progress_now();
      if (slurm_.progress) {
        slurm_.progress(progress, now.ok() ? now.value().describe() : now.error().message);
      }
      if (now.ok()) {
        for (const auto& [shard, state] : now.value().tasks) {
          last[shard] = state;
        }
      }
      const bool is_whole = progress.done >= progress.units;
      if (now.ok() && now.value().has_task(is_whole ? is_running_or_pending : is_live)) {
        ended.reset();  // a task was requeued
      } else if (now.ok()) {
        ended = ended.value_or(Clock::now());
        if (!is_whole) {
          // Slurm cancels the collecting job if a task fails or is cancelled before the collecting
          // job begins.
          const bool has_failed = is_failure(now.value().collector) ||
                                  std::any_of(last.begin(), last.end(), [](const auto& task) {
                                    return is_failure(task.second);
                                  });
          if (has_failed || Clock::now() - *ended > kSeenWithin) {
            cancel_job(submitted_.collector);
            return report_missing(last);
          }
        } else if (is_running_or_pending(now.value().collector)) {
          cancel_job(submitted_.collector, {"--state=PENDING"});
        } else {
          return collect();
        }
      }
      if (!pause(ended ? std::chrono::milliseconds(500) : poll_period())) {
        return leave_running();
      }
    }
  }

  SlurmEnd report_missing(const std::map<int, std::string>& last) const {
    const auto done = read_rows(options_.directory, sweep_.plan, identity_).done;
    for (const int shard : incomplete_shards(sweep_.plan, submitted_.shards, done)) {
      const auto state = last.find(shard);
      const fs::path log = log_of(shard);
      slurm_.print_line(fmt::format("shard {} is incomplete: {}; {}", shard,
                                    state == last.end() ? "no longer in the queue" : state->second,
                                    fs::exists(log)
                                        ? log.string() + " ends with: " + last_line_of(log)
                                        : "it did not start"));
    }
    slurm_.print_line("run the same command to submit the missing shards");
    return SlurmEnd::kIncomplete;
  }

  const Sweep& sweep_;
  const SweepIdentity& identity_;
  const std::string& what_;
  const SweepOptions& options_;
  const SlurmOptions& slurm_;
  fs::path folder_;
  SlurmJobs submitted_;
  Clock::time_point start_ = Clock::now();
  std::optional<std::size_t> done_before_;
};

}  // namespace

SlurmEnd run_on_slurm(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                      const SweepOptions& options, const SlurmOptions& slurm) {
  return SlurmRun(sweep, identity, what, options, slurm).run();
}

}  // namespace vantage::experiments
