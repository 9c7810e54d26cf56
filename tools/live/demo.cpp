#include "tools/live/demo.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <filesystem>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "core/write_file.hpp"
#include "logs/picture/picture.hpp"
#include "logs/record/log_spool.hpp"
#include "logs/record/recorder.hpp"
#include "tools/live/node_thread.hpp"
#include "tools/live/trial_display.hpp"
#include "trial/observe/announcer.hpp"
#include "trial/observe/observer.hpp"

namespace vantage::tools {
namespace {

constexpr auto kWait = std::chrono::milliseconds(20);

void draw(const scenario::Scenario& scenario, const logs::Scene& scene, DemoResult& result) {
  try {
    write_file(result.svg_path, logs::draw_picture(scenario, scene, result.summary));
  } catch (const std::runtime_error& error) {
    result.failures.emplace_back(error.what());
    result.svg_path.clear();
    result.png_path.clear();
    return;
  }
  try {
    const Result<std::string> png = logs::render_png(result.svg_path, result.png_path);
    if (!png.ok()) {
      result.png_path.clear();
      result.png_error = png.error().message;
    }
  } catch (const std::runtime_error& error) {
    result.failures.emplace_back(error.what());
    result.png_path.clear();
  }
}

}  // namespace

// Long function: it creates objects in such an order that each outlives the later ones.
DemoResult run_demo(const scenario::Scenario& scenario,
                    const std::vector<trial::NodeRecipe>& recipes, const DemoOptions& options,
                    const std::function<bool()>& stop) {
  std::error_code error;
  std::filesystem::create_directories(options.directory, error);
  if (error) {
    throw StartupError(options.directory + ": cannot create this folder: " + error.message());
  }
  const std::string stem = (std::filesystem::path(options.directory) / scenario.name).string();
  DemoResult result;
  result.log_path = logs::unused_path(stem + ".lcmlog");
  result.svg_path = stem + ".svg";
  result.png_path = stem + ".png";
  require_writable(result.svg_path);

  const bus::SteadyClock clock;
  bus::InProcessHub hub;
  logs::SpoolOptions spool_options;
  spool_options.path = result.log_path;
  logs::LogSpool log(spool_options);
  const auto recorded = hub.connect();
  const logs::Recorder recorder(
      *recorded, clock,
      [&log](Time time, std::string_view channel, std::span<const std::uint8_t> data) {
        return log.write(time, channel, data);
      });
  const std::shared_ptr<void> watcher = options.attach ? options.attach(hub) : nullptr;
  const auto own_transport = hub.connect();
  bus::Bus own_bus(*own_transport, bus::random_run_id());
  trial::Announcer announcer(own_bus, scenario, "demo");
  const Time start = clock.now();
  trial::TrialObserver observer(own_bus, scenario, start);
  announcer.publish(start);

  std::atomic<bool> is_over = false;
  std::deque<NodeThread> nodes;
  const std::shared_ptr<void> ends_them(nullptr, [&is_over](void*) { is_over = true; });
  for (const trial::NodeRecipe& recipe : recipes) {
    nodes.emplace_back(hub, clock, recipe);
  }
  for (NodeThread& node : nodes) {
    node.start([&is_over] { return is_over.load(); }, [&is_over] { is_over = true; });
  }
  const auto drain = [&](std::chrono::microseconds timeout) {
    recorded->handle(timeout);
    return own_bus.handle(std::chrono::microseconds(0));
  };

  const Time end = start + from_seconds(scenario.duration_s);
  TrialDisplay display(form_of(options.quiet, options.live_table));
  std::vector<std::string> notices;
  const auto report_notices = [&] {
    for (std::string& notice : log.take_notices()) {
      options.warn(notice);
      notices.push_back(std::move(notice));
    }
  };
  while (!is_over && !stop() && clock.now() < end) {
    drain(kWait);
    report_notices();
    announcer.tick(clock.now());
    if (const Time now = clock.now(); display.is_due(now)) {
      display.show(now, scenario, observer.metrics(), to_seconds(now - start));
    }
  }
  is_over = true;
  const Time ended = clock.now();
  std::int64_t lost = 0;
  for (NodeThread& node : nodes) {
    node.join();
    lost += node.messages_lost();
    if (!node.failure().empty()) {
      result.failures.push_back(node.failure());
    }
  }
  while (drain(std::chrono::microseconds(0)) > 0) {
  }
  log.close();
  const logs::SpoolReport recording = log.report();
  lost += recording.events_lost + recorded->stats().queue_overflows + own_bus.messages_lost() +
          own_transport->stats().queue_overflows;
  result.summary = observer.metrics().finish(ended, lost);
  report_notices();
  if (!recording.is_good()) {  // a slow disk without losses is not a failure
    std::ranges::move(notices, std::back_inserter(result.failures));
  }
  draw(scenario, observer.scene(), result);
  return result;
}

}  // namespace vantage::tools
