#include "tools/up/log_keeper.hpp"

#include <filesystem>
#include <system_error>

#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;

constexpr auto kPatience = std::chrono::seconds(5);

}  // namespace

// Passes "--free-mib 0", because run_up() has already checked the free space.
ProcessSpec recorder_process(const ProcessSettings& settings, const std::string& log_path,
                             int sync_ms) {
  ProcessSpec process{kRecorderProcess,
                      {settings.executables + "/vantage", "log", "record", log_path, "--append",
                       "--url", settings.url, "--scenario", settings.scenario_path, "--free-mib",
                       "0", "--sync-ms", std::to_string(sync_ms), "--quiet"}};
  process.patience_s = kPatienceS;
  process.keep_open = settings.keep_open;
  return process;
}

// A non-empty file shows that the recorder receives messages.
LogKeeper::LogKeeper(const ProcessSpec& recorder, const std::string& path,
                     const RestartPolicy& policy, trial::Announcer& announcer,
                     const bus::Clock& clock)
    : path_(path), supervisor_(policy) {
  outcome_.path = path;
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, error))) {
    throw StartupError(path + ": file exists, and logs are never overwritten: move it or give " +
                       "another name");
  }
  ProcessSpec spec = recorder;
  spec.before_restart = [this] { prepare_restart(); };
  supervisor_.start(spec, monotonic_ns());
  const Time give_up = clock.now() + kPatience;
  while (true) {
    announcer.publish(clock.now());
    if (const auto ended = supervisor_.find(kRecorderProcess)->wait(milliseconds(50))) {
      throw StartupError("the recorder of " + path + " ended immediately (" + ended->describe() +
                         ")");
    }
    const auto size = std::filesystem::file_size(path, error);
    if (!error && size > 0) {
      return;
    }
    if (clock.now() > give_up) {
      throw StartupError("the recorder of " + path + " receives no messages");
    }
  }
}

// A failure to trim must not end the flight, so it only sets is_damaged_.
logs::TrimmedLog LogKeeper::trim() {
  logs::TrimmedLog trimmed;
  try {
    trimmed = logs::trim_log(path_);
  } catch (const StartupError&) {
    trimmed = {};
  }
  outcome_.bytes_dropped += trimmed.dropped_bytes;
  if (trimmed.size_bytes ==
      0) {  // a missing event is damage, because the constructor has waited for a first event
    is_damaged_ = true;
    last_before_.reset();
  }
  return trimmed;
}

void LogKeeper::prepare_restart() {
  note_first_event();
  const logs::TrimmedLog trimmed = trim();
  // If the recorder dies again before it has written an event, the same gap continues.
  if (!last_before_) {
    last_before_ = trimmed.last;
  }
  size_before_bytes_ = trimmed.size_bytes;
}

void LogKeeper::note_first_event() {
  if (!last_before_) {
    return;
  }
  if (const auto first = logs::event_time_at(path_, size_before_bytes_)) {
    outcome_.unrecorded_s += to_seconds(*first - *last_before_);
    last_before_.reset();
  }
}

std::vector<SupervisorEvent> LogKeeper::poll(Supervisor::Nanoseconds monotonic_ns) {
  note_first_event();
  return supervisor_.poll(monotonic_ns);
}

bool LogKeeper::tail_contains(std::span<const std::uint8_t> bytes) const {
  return logs::ends_with(path_, bytes);
}

std::vector<std::string> LogKeeper::stop(milliseconds patience) {
  auto killed = supervisor_.stop_all(patience);
  for (const SupervisedStatus& status : supervisor_.status(monotonic_ns())) {
    outcome_.is_good = killed.empty() && status.last_end == "exit 0";
  }
  if (!killed.empty()) {
    trim();
  }
  note_first_event();
  return killed;
}

LogOutcome LogKeeper::outcome() const {
  LogOutcome out = outcome_;
  out.restarts = supervisor_.restarts();
  out.is_good = out.is_good && !is_damaged_;
  return out;
}

}  // namespace vantage::tools
