#include "trial/trial.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "core/check.hpp"
#include "scenario/search_name.hpp"

namespace vantage::trial {

Time trial_start(const scenario::Scenario& scenario) {
  const std::int64_t round_us =
      from_seconds(scenario.planner.step_s).count() * scenario.planner.execute_steps;
  constexpr std::int64_t kEarliestUtime = 1'700'000'000'000'000;
  return from_utime((kEarliestUtime + round_us - 1) / round_us * round_us);
}

Trial::Trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
             const std::string& log_path)
    : start_(trial_start(scenario)),
      planned_end_(start_ + from_seconds(scenario.duration_s)),
      now_(start_),
      loop_(start_, scenario) {
  require(scenario.planner.node_budget > 0, "a trial in virtual time needs a node budget");
  if (!log_path.empty()) {
    log_ = std::make_unique<logs::LogWriter>(log_path);
    recorded_ = loop_.connect();
    recorder_ = std::make_unique<logs::Recorder>(
        *recorded_, loop_.clock(),
        [this](Time time, std::string_view channel, std::span<const std::uint8_t> data) {
          return log_->write(time, channel, data);
        });
    loop_.on_delivered([this] {
      while (recorded_->handle(std::chrono::microseconds(0)) > 0) {
      }
    });
  }
  bus::Bus& own_bus = loop_.add_bus(deterministic_run_id(scenario.seed, "TRIAL"));
  observer_ = std::make_unique<TrialObserver>(own_bus, scenario, start_);
  announcer_ = std::make_unique<Announcer>(own_bus, scenario, "trial");
  announcer_->publish(start_);
  for (const NodeRecipe& recipe : recipes) {
    loop_.add_node(recipe, deterministic_run_id(scenario.seed, recipe.name));
  }
}

Trial::~Trial() = default;

void Trial::advance_to(Time end) {
  end = std::min(end, planned_end_);
  while (now_ < end) {
    now_ = std::min(announcer_->next_tick(), end);
    loop_.run_until(now_);
    announcer_->tick(now_);
  }
}

TrialResult Trial::result() {
  loop_.deliver();
  std::int64_t unrecorded = 0;
  std::optional<Error> log_error;
  if (log_) {
    log_->flush();
    log_error = log_->error();
    unrecorded = log_->events_lost() + recorded_->stats().queue_overflows;
  }
  logs::TrialMetrics metrics = observer_->metrics();  // copied: finish() evaluates pending steps
  TrialResult result;
  result.summary = metrics.finish(now_, loop_.messages_lost() + unrecorded);
  result.scene = observer_->scene();
  if (loop_.network() != nullptr) {
    result.air_bytes = loop_.network()->bytes_sent();
  }
  result.was_stopped = now_ < planned_end_;
  result.log_error = std::move(log_error);
  return result;
}

TrialResult run_trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
                      const TrialOptions& options) {
  if (scenario::is_external(scenario.planner)) {
    throw StartupError(
        "planner.algorithm: external requires a planner process on the bus; a trial in virtual "
        "time has none: use `vantage up`, or Trial(scenario, planners=…) in Python");
  }
  Trial trial(scenario, recipes, options.log_path);
  constexpr int kProgressReports = 100;
  constexpr Duration kStopPeriod{500'000};
  int reported = 0;
  bool is_stopped = false;
  while (!is_stopped && trial.time() < trial.planned_end()) {
    trial.advance_to(trial.time() + kStopPeriod);
    is_stopped = trial.is_log_lost() ||
                 (trial.time() < trial.planned_end() && options.stop && options.stop());
    const double share =
        to_seconds(trial.time() - trial.start()) / to_seconds(trial.planned_end() - trial.start());
    if (options.progress && static_cast<int>(share * kProgressReports) > reported) {
      reported = static_cast<int>(share * kProgressReports);
      options.progress(share);
    }
  }
  return trial.result();
}

}  // namespace vantage::trial
