#include "tools/up/log_keeper.hpp"

#include <filesystem>
#include <system_error>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "tools/up/log_tail.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;

constexpr const char* kLogger = "lcm-logger";
constexpr auto kPatience = std::chrono::seconds(5);

}  // namespace

ProcessSpec logger_process(const std::string& url, const std::string& log_path) {
  return {kLogger, {kLogger, "--quiet", "--append", "--lcm-url=" + url, log_path}};
}

// The logger writes what it hears, so it listens once its file is no longer empty.
LogKeeper::LogKeeper(const std::string& url, const std::string& path, const RestartPolicy& policy,
                     Announcer& announcer, const bus::Clock& clock)
    : path_(path), supervisor_(policy) {
  outcome_.path = path;
  std::error_code error;
  std::filesystem::remove(path, error);
  ProcessSpec spec = logger_process(url, path);
  spec.before_restart = [this] { prepare_restart(); };
  supervisor_.start(spec, monotonic_ns());
  const Time give_up = clock.now() + kPatience;
  while (true) {
    announcer.publish(clock.now());
    if (const auto ended = supervisor_.find(kLogger)->wait(milliseconds(50))) {
      throw StartupError("lcm-logger ended at once (" + ended->describe() + "); can it write " +
                         path + " and use " + url + "?");
    }
    const auto size = std::filesystem::file_size(path, error);
    if (!error && size > 0) {
      return;
    }
    if (clock.now() > give_up) {
      throw StartupError("lcm-logger hears nothing on " + url);
    }
  }
}

void LogKeeper::prepare_restart() {
  note_first_event();
  const TrimmedLog trimmed = trim_log(path_);
  outcome_.bytes_dropped += trimmed.dropped_bytes;
  // A logger that dies again before it wrote anything leaves the gap open.
  if (!last_before_) {
    last_before_ = trimmed.last;
  }
  size_before_bytes_ = trimmed.size_bytes;
}

void LogKeeper::note_first_event() {
  if (!last_before_) {
    return;
  }
  if (const auto first = event_time_at(path_, size_before_bytes_)) {
    outcome_.unrecorded_s += to_seconds(*first - *last_before_);
    last_before_.reset();
  }
}

std::vector<SupervisorEvent> LogKeeper::poll(Supervisor::Nanoseconds monotonic_ns) {
  note_first_event();
  return supervisor_.poll(monotonic_ns);
}

bool LogKeeper::holds(std::span<const std::uint8_t> bytes) const { return ends_with(path_, bytes); }

std::vector<std::string> LogKeeper::stop(milliseconds patience) {
  auto killed = supervisor_.stop_all(patience);
  if (!killed.empty()) {
    outcome_.bytes_dropped += trim_log(path_).dropped_bytes;
  }
  note_first_event();
  return killed;
}

LogOutcome LogKeeper::outcome() const {
  LogOutcome out = outcome_;
  out.restarts = supervisor_.restarts();
  return out;
}

}  // namespace vantage::tools
