#include "tools/supervisor/supervisor.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "core/time.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;
using SteadyTime = std::chrono::steady_clock::time_point;

constexpr milliseconds kHurryPeriod{20};

// Loops, because a signal may end a single wait early.
std::optional<ChildExit> wait_until(Child& child, SteadyTime deadline,
                                    const std::function<bool()>& hurry) {
  while (true) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
    const bool is_over = left.count() <= 0 || (hurry && hurry());
    const auto ended = child.wait(is_over ? milliseconds(0) : std::min(left, kHurryPeriod));
    if (ended || is_over) {
      return ended;
    }
  }
}

std::string output_of(const ProcessSpec& spec) { return spec.folder + "/output.txt"; }

/// Returns the last line of the process's output file, as "; it said '...' (FILE)"; "" if the
/// process has no output file or the file is empty.
std::string last_output_line(const ProcessSpec& spec) {
  constexpr std::streamoff kEnd_bytes = 400;
  if (spec.folder.empty()) {
    return "";
  }
  std::ifstream output(output_of(spec), std::ios::binary | std::ios::ate);
  const std::streamoff size = output.tellg();
  output.seekg(std::max<std::streamoff>(0, size - kEnd_bytes));
  std::string last;
  for (std::string line; std::getline(output, line);) {
    const auto is_word = [](char c) { return c > ' ' && c < 0x7F; };
    last = std::any_of(line.begin(), line.end(), is_word) ? line : last;
  }
  std::erase_if(last, [](char c) { return c < ' ' || c == 0x7F; });
  return last.empty() ? "" : fmt::format("; last output: '{}' ({})", last, output_of(spec));
}

/// Starts the process of `spec` with a new pipe `liveness` for its signs of life.
Result<Child> start_child(const ProcessSpec& spec, LivenessReceiver& liveness) {
  ChildOptions options{-1, spec.folder, spec.end_signal};
  options.keep_open = spec.keep_open;
  if (spec.patience_s > 0.0) {
    if (!liveness.open()) {
      return Error{std::string("cannot create a pipe: ") + std::strerror(errno)};
    }
    options.keep_open.push_back(liveness.child_end());
    options.environment.push_back(
        fmt::format("{}={}", LivenessSender::kDescriptorVariable, liveness.child_end()));
    options.blocks_stop_signals = true;
  }
  if (!spec.folder.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(spec.folder, failed);
    for (const auto& [name, content] : spec.files) {
      std::ofstream file(spec.folder + "/" + name);
      file << content;
      if (!file.flush()) {
        return Error{spec.folder + "/" + name + ": cannot be written"};
      }
    }
    const std::string path = output_of(spec);
    options.output =
        failed ? -1 : ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (options.output < 0) {
      return Error{path + ": " + (failed ? failed.message() : std::strerror(errno))};
    }
  }
  Result<Child> child = Child::start(spec.arguments, options);
  if (options.output >= 0) {
    ::close(options.output);
  }
  liveness.close_child_end();
  return child;
}

Time time_of(Supervisor::Nanoseconds monotonic_ns) { return from_utime(monotonic_ns / 1'000); }

}  // namespace

using models::SupervisedPhase;
using Kind = SupervisorEvent::Kind;

void Supervisor::start(const ProcessSpec& spec, Nanoseconds monotonic_ns) {
  LivenessReceiver liveness;
  Result<Child> child = start_child(spec, liveness);
  if (!child.ok()) {
    throw StartupError("cannot start " + spec.name + ": " + child.error().message);
  }
  Supervised process{spec, RestartSchedule(policy_), std::move(child).value()};
  process.liveness = std::move(liveness);
  process.schedule.on_start(monotonic_ns);
  if (spec.patience_s > 0.0) {
    watchdog_.watch(spec.name, spec.patience_s);
  }
  processes_.push_back(std::move(process));
}

void Supervisor::take_signs(Supervised& process, Nanoseconds now_ns) {
  const LivenessReceiver::Report signs = process.liveness.take();
  if (signs.any) {
    watchdog_.on_sign(process.spec.name, time_of(now_ns));
  }
  if (signs.in_flight != InFlight::kUnknown) {
    process.in_flight = signs.in_flight;
  }
}

// Kills processes that hang, so that poll() restarts them.
void Supervisor::kill_hung(Nanoseconds now_ns, std::vector<SupervisorEvent>& events) {
  for (const std::string& name : watchdog_.overdue(time_of(now_ns))) {
    if (Child* const child = find(name)) {
      child->send(SIGKILL);
      events.push_back({name, Kind::kHung, name + " sent no heartbeat: killing it"});
    }
  }
}

SupervisorEvent Supervisor::on_end(Supervised& process, const ChildExit& how, Nanoseconds now_ns) {
  take_signs(process, now_ns);
  // If a driver fails in flight, its vehicle needs a new driver. After a second request to end, the
  // autopilot lands the vehicle instead.
  const bool is_left = process.in_flight == InFlight::kYes && end_requests_ == 1;
  const bool was_requested = !process.spec.vehicle.empty() && end_requests_ > 0;
  if (was_requested && (how.is_success() || !is_left)) {
    process.child.reset();
    process.last_end = how.describe();
    process.phase = SupervisedPhase::kEnded;
    watchdog_.on_end(process.spec.name);
    return {process.spec.name, Kind::kEnded, process.spec.name + " has ended"};
  }
  return start_again_later(process, how.describe(), now_ns);
}

SupervisorEvent Supervisor::start_again_later(Supervised& process, const std::string& how,
                                              Nanoseconds now_ns) {
  process.child.reset();
  process.last_end = how;
  watchdog_.on_end(process.spec.name);
  const bool is_needed = process.in_flight == InFlight::kYes;
  const auto restart_at_ns = process.schedule.on_end(now_ns, is_needed);
  if (!restart_at_ns) {
    process.phase = SupervisedPhase::kGivenUp;
    const RestartPolicy& policy = process.schedule.policy();
    return {process.spec.name, Kind::kGivenUp,
            fmt::format("{} ended ({}) and is given up: {} restarts within {:g} s did not help{}{}",
                        process.spec.name, how, policy.restarts_max, policy.window_s,
                        process.spec.is_essential ? "; the trial cannot continue without it" : "",
                        last_output_line(process.spec))};
  }
  process.phase = SupervisedPhase::kWaiting;
  process.restart_at_ns = *restart_at_ns;
  return {process.spec.name, Kind::kEnded,
          fmt::format("{} ended ({}); starting it again in {:.1f} s{}", process.spec.name, how,
                      static_cast<double>(*restart_at_ns - now_ns) * 1e-9,
                      last_output_line(process.spec))};
}

SupervisorEvent Supervisor::restart(Supervised& process, Nanoseconds now_ns) {
  if (process.spec.before_restart) {
    process.spec.before_restart();
  }
  process.schedule.on_start(now_ns);
  Result<Child> child = start_child(process.spec, process.liveness);
  if (!child.ok()) {
    return start_again_later(process, child.error().message, now_ns);
  }
  process.child.emplace(std::move(child).value());
  process.phase = SupervisedPhase::kRunning;
  watchdog_.on_start(process.spec.name, time_of(now_ns));
  if (end_requests_ > 0) {
    request_end(process);
  }
  return {process.spec.name, Kind::kStarted,
          fmt::format("{} started again (restart {}, {:.1f} s down in total)", process.spec.name,
                      process.schedule.restarts(), process.schedule.down_s(now_ns))};
}

std::vector<SupervisorEvent> Supervisor::poll(Nanoseconds monotonic_ns) {
  std::vector<SupervisorEvent> events;
  for (Supervised& process : processes_) {
    take_signs(process, monotonic_ns);
  }
  kill_hung(monotonic_ns, events);
  for (Supervised& process : processes_) {
    if (process.child) {
      if (const auto ended = process.child->wait(std::chrono::milliseconds(0))) {
        events.push_back(on_end(process, *ended, monotonic_ns));
      }
    } else if (process.phase == SupervisedPhase::kWaiting &&
               monotonic_ns >= process.restart_at_ns) {
      events.push_back(restart(process, monotonic_ns));
    }
  }
  return events;
}

// Sends two different signals, as the second of two equal pending signals would be lost.
void Supervisor::request_end(Supervised& process) const {
  if (!process.spec.vehicle.empty() && process.child) {
    process.child->send(SIGTERM);
    if (end_requests_ > 1) {
      process.child->send(SIGINT);
    }
  }
}

void Supervisor::end_drivers() {
  ++end_requests_;
  for (Supervised& process : processes_) {
    request_end(process);
    const bool is_restart_needless =
        process.phase == SupervisedPhase::kWaiting && process.in_flight != InFlight::kYes;
    if (!process.spec.vehicle.empty() && is_restart_needless) {
      process.phase = SupervisedPhase::kEnded;
    }
  }
}

bool Supervisor::have_drivers_ended() const {
  return std::all_of(processes_.begin(), processes_.end(), [](const Supervised& process) {
    const bool is_over =
        process.phase == SupervisedPhase::kEnded || process.phase == SupervisedPhase::kGivenUp;
    return process.spec.vehicle.empty() || is_over;
  });
}

void Supervisor::send_to_ours(int signal) {
  for (Supervised& process : processes_) {
    if (process.child && process.spec.patience_s > 0.0) {
      process.child->send(signal);
    }
  }
}

std::vector<std::string> Supervisor::stop_all(milliseconds patience,
                                              const std::function<bool()>& hurry) {
  std::vector<std::string> killed;
  for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
    if (process->child) {
      process->child->send(process->spec.end_signal);
    }
  }
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
    if (process->phase == SupervisedPhase::kWaiting) {
      process->phase = SupervisedPhase::kEnded;
    }
    if (!process->child) {
      continue;
    }
    const auto ended = wait_until(*process->child, deadline, hurry);
    if (!ended) {
      killed.push_back(process->spec.name);
    }
    take_signs(*process, monotonic_ns());
    process->last_end = ended ? ended->describe() : "killed";
    process->child.reset();  // kills and reaps the process and its children
    process->phase = SupervisedPhase::kEnded;
  }
  return killed;
}

std::vector<SupervisedStatus> Supervisor::status(Nanoseconds monotonic_ns) const {
  std::vector<SupervisedStatus> out;
  for (const Supervised& process : processes_) {
    out.push_back({process.spec.name, process.phase, process.schedule.restarts(),
                   process.schedule.down_s(monotonic_ns), process.last_end,
                   process.child ? process.child->pid() : 0, process.spec.is_essential,
                   process.spec.vehicle, process.in_flight});
  }
  return out;
}

int Supervisor::restarts() const {
  int total = 0;
  for (const Supervised& process : processes_) {
    total += process.schedule.restarts();
  }
  return total;
}

std::optional<std::string> Supervisor::lost_essential() const {
  for (const Supervised& process : processes_) {
    if (process.spec.is_essential && process.phase == SupervisedPhase::kGivenUp) {
      return process.spec.name;
    }
  }
  return std::nullopt;
}

Child* Supervisor::find(const std::string& name) {
  for (Supervised& process : processes_) {
    if (process.spec.name == name && process.child) {
      return &*process.child;
    }
  }
  return nullptr;
}

}  // namespace vantage::tools
