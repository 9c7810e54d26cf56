#include "tools/up/host_readiness.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/real_time.hpp"
#include "tools/live/screen.hpp"
#include "tools/up/process_plan.hpp"
#include "trial/observe/network_conflicts.hpp"

namespace vantage::tools {
namespace {

// Columns of the line "cpu" (proc(5)): user, nice, system, idle, iowait, irq, softirq, steal. User
// and nice include the time of guests.
constexpr std::size_t kColumns = 8;
constexpr std::size_t kNice = 1;
constexpr std::size_t kIdle = 3;
constexpr std::size_t kWaitingForDisk = 4;

std::optional<ProcessorTimes> read_processor_times() {
  std::ifstream file("/proc/stat");
  return processor_times(std::string{std::istreambuf_iterator<char>(file), {}});
}

}  // namespace

std::optional<ProcessorTimes> processor_times(std::string_view stat) {
  constexpr std::string_view kHead = "cpu ";
  if (!stat.starts_with(kHead)) {
    return std::nullopt;
  }
  stat.remove_prefix(kHead.size());
  ProcessorTimes out;
  for (std::size_t i = 0; i < kColumns; ++i) {
    stat.remove_prefix(std::min(stat.find_first_not_of(' '), stat.size()));
    std::int64_t ticks = 0;
    const auto parsed = std::from_chars(stat.data(), stat.data() + stat.size(), ticks);
    if (parsed.ec != std::errc{} || ticks < 0) {
      return std::nullopt;
    }
    stat.remove_prefix(static_cast<std::size_t>(parsed.ptr - stat.data()));
    out.total += ticks;
    out.free += i == kNice || i == kIdle || i == kWaitingForDisk ? ticks : 0;
  }
  return out;
}

std::optional<double> free_processors(const ProcessorTimes& before, const ProcessorTimes& after,
                                      unsigned processors) {
  const std::int64_t total = after.total - before.total;
  if (total <= 0) {
    return std::nullopt;
  }
  return static_cast<double>(processors) * static_cast<double>(after.free - before.free) /
         static_cast<double>(total);
}

std::optional<std::string> host_fault(const HostReadiness& host) {
  if (host.has_priority || !host.free_processors || *host.free_processors >= kFreeProcessorsMin) {
    return std::nullopt;
  }
  return fmt::format(
      "drivers and motion capture would be late: this machine has {:.1f} free processors (at least "
      "{:g} are needed) and grants no real-time priority (SCHED_FIFO {}); end other programs, "
      "raise "
      "the rtprio limit (ulimit -r {}, LimitRTPRIO= of systemd) or grant CAP_SYS_NICE",
      *host.free_processors, kFreeProcessorsMin, kDriverPriority, kDriverPriority);
}

LoadMeter::LoadMeter() : begin_(read_processor_times()) {}

std::optional<double> LoadMeter::free_processors() const {
  const auto end = read_processor_times();
  return begin_ && end ? tools::free_processors(*begin_, *end, std::thread::hardware_concurrency())
                       : std::nullopt;
}

UpOptions with_priority(const scenario::Scenario& scenario, UpOptions options,
                        const LoadMeter& load) {
  const bool has_drivers = !robots_with_driver(scenario).empty() ||
                           scenario.mocap.device != scenario::DeviceSource::kDirect;
  if (!has_drivers) {
    return options;
  }
  const bool is_granted = grants_fifo(kDriverPriority);
  options.driver_priority = is_granted ? kDriverPriority : 0;
  const bool has_priority = is_granted || runs_in_real_time();
  // `load` is measured while run_up() listens for other hosts. With ignore_others run_up() does not
  // listen, so this function waits for the same time.
  if (!has_priority && options.ignore_others) {
    std::this_thread::sleep_for(trial::kListenTime);
  }
  const auto fault = has_priority ? std::nullopt : host_fault({false, load.free_processors()});
  if (fault && options.fly && !options.ignore_load) {
    throw StartupError(*fault + ", or fly anyway with --ignore-load");
  }
  if (fault) {
    print_line("vantage: warning: " + *fault, stderr);
  }
  return options;
}

}  // namespace vantage::tools
