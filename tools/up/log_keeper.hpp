#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/node/clock.hpp"
#include "logs/record/log_tail.hpp"
#include "tools/supervisor/supervisor.hpp"
#include "tools/up/process_plan.hpp"
#include "trial/observe/announcer.hpp"

namespace vantage::tools {

/// Process name of the recorder.
inline constexpr const char* kRecorderProcess = "recorder";

/// Returns the process `vantage log record` that appends to `log_path` and syncs it to the disk
/// after every `sync_ms`. It signs and verifies messages as the scenario of `settings` requires.
ProcessSpec recorder_process(const ProcessSettings& settings, const std::string& log_path,
                             int sync_ms);

/// Result of recording a trial.
struct LogOutcome {
  std::string path;  ///< empty: no recording was requested
  int restarts = 0;
  /// s; total length of all gaps. A gap is the time from the last event before the recorder died
  /// to the next event.
  double unrecorded_s = 0.0;
  std::uint64_t bytes_dropped = 0;  ///< bytes of events that were incomplete when the recorder died
  bool is_to_the_end = true;        ///< the log contains the last published message
  /// The last recorder ended with exit code 0, and the file was intact at each restart.
  bool is_good = true;
};

/// Supervisor of a recorder that writes one file. When the recorder dies, its incomplete last event
/// is cut off and a new recorder appends. The file stays valid; its event numbers restart there.
class LogKeeper {
 public:
  /// Starts the recorder. Publishes SCENARIO until the recorder has written it as the first event.
  /// @throws StartupError if `path` exists, or the recorder cannot run, write or receive.
  LogKeeper(const ProcessSpec& recorder, const std::string& path, const RestartPolicy& policy,
            trial::Announcer& announcer, const bus::Clock& clock);
  LogKeeper(const LogKeeper&) = delete;
  LogKeeper& operator=(const LogKeeper&) = delete;
  LogKeeper(LogKeeper&&) = delete;
  LogKeeper& operator=(LogKeeper&&) = delete;
  ~LogKeeper() = default;

  /// Restarts the recorder if it has died; see Supervisor::poll().
  std::vector<SupervisorEvent> poll(Supervisor::Nanoseconds monotonic_ns);
  /// True if the end of the file contains `bytes`, the last published message.
  [[nodiscard]] bool tail_contains(std::span<const std::uint8_t> bytes) const;
  /// Ends the recorder, which first writes all received messages. Returns the recorder's name if it
  /// had to be killed. In that case its incomplete last event is cut off, and is_good is false.
  std::vector<std::string> stop(std::chrono::milliseconds patience);

  [[nodiscard]] const Supervisor& supervisor() const { return supervisor_; }
  [[nodiscard]] LogOutcome outcome() const;

 private:
  logs::TrimmedLog trim();
  void prepare_restart();
  void note_first_event();

  std::string path_;
  Supervisor supervisor_;
  LogOutcome outcome_;
  std::optional<Time> last_before_;  ///< last event before a restart; empty after the next event
  std::uint64_t size_before_bytes_ = 0;
  bool is_damaged_ = false;  ///< the file was missing, unreadable or could not be cut at a restart
};

}  // namespace vantage::tools
