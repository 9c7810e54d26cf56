#include "tools/trial/trial.hpp"

#include <algorithm>
#include <chrono>
#include <memory>

#include "core/check.hpp"
#include "logs/record/log_writer.hpp"
#include "logs/record/recorder.hpp"
#include "tools/observe/announcer.hpp"
#include "tools/observe/observer.hpp"
#include "tools/trial/virtual_loop.hpp"

namespace vantage::tools {

Time trial_start(const models::Scenario& scenario) {
  const std::int64_t round_us =
      from_seconds(scenario.planner.step_s).count() * scenario.planner.execute_steps;
  constexpr std::int64_t kEarliestUtime = 1'700'000'000'000'000;
  return from_utime((kEarliestUtime + round_us - 1) / round_us * round_us);
}

TrialResult run_trial(const models::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
                      const TrialOptions& options) {
  require(scenario.planner.node_budget > 0, "a trial in virtual time needs a node budget");
  const Time start = trial_start(scenario);
  const Time planned_end = start + from_seconds(scenario.duration_s);
  Time end = planned_end;
  VirtualTimeLoop loop(start);

  std::unique_ptr<logs::LogWriter> log;
  std::unique_ptr<bus::Transport> recorded;
  std::unique_ptr<logs::Recorder> recorder;
  if (!options.log_path.empty()) {
    log = std::make_unique<logs::LogWriter>(options.log_path);
    recorded = loop.connect();
    recorder = std::make_unique<logs::Recorder>(
        *recorded, loop.clock(),
        [&log](Time time, std::string_view channel, std::span<const std::uint8_t> data) {
          return log->write(time, channel, data);
        });
    loop.on_delivered([&recorded] {
      while (recorded->handle(std::chrono::microseconds(0)) > 0) {
      }
    });
  }
  bus::Bus& own_bus = loop.add_bus(deterministic_run_id(scenario.seed, "TRIAL"));
  TrialObserver observer(own_bus, scenario, start);
  Announcer announcer(own_bus, scenario, "trial");
  announcer.publish(start);
  for (const NodeRecipe& recipe : recipes) {
    loop.add_node(recipe, deterministic_run_id(scenario.seed, recipe.name));
  }

  constexpr int kProgressReports = 100;
  constexpr Duration kStopPeriod{500'000};
  int reported = 0;
  for (Time now = start; now < end;) {
    now = std::min({announcer.next_tick(), now + kStopPeriod, end});
    loop.run_until(now);
    announcer.tick(now);
    const bool is_lost = log && log->error();
    if (now < planned_end && (is_lost || (options.stop && options.stop()))) {
      end = now;
    }
    const double share = to_seconds(now - start) / to_seconds(planned_end - start);
    if (options.progress && static_cast<int>(share * kProgressReports) > reported) {
      reported = static_cast<int>(share * kProgressReports);
      options.progress(share);
    }
  }
  loop.deliver();
  TrialResult result;
  if (log) {
    result.log_error = log->close();
  }
  const std::int64_t unrecorded = log ? log->events_lost() + recorded->stats().queue_overflows : 0;
  result.summary = observer.metrics().finish(end, loop.messages_lost() + unrecorded);
  result.scene = observer.scene();
  result.was_stopped = end < planned_end;
  return result;
}

}  // namespace vantage::tools
