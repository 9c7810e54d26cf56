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

/// The name of the recorder among the processes.
inline constexpr const char* kRecorderProcess = "recorder";

/// `vantage log record`, appending to `log_path`, signing as the scenario of `places` says.
ProcessSpec recorder_process(const ProcessPlaces& places, const std::string& log_path);

/// What became of a trial's log.
struct LogOutcome {
  std::string path;  ///< empty: nothing was to be recorded
  int restarts = 0;
  double unrecorded_s = 0.0;        ///< from the last event before each death to the first after it
  std::uint64_t bytes_dropped = 0;  ///< of events that a death of the logger cut in two
  bool is_to_the_end = true;        ///< what was published last is in it
  /// The last recorder lost nothing and was refused nothing, and what was there at each restart is.
  bool is_good = true;
};

/// Keeps a recorder writing one file. When it dies the event it was writing is cut off and the next
/// one appends, so the file stays whole; its event numbers begin again there.
class LogKeeper {
 public:
  /// Starts the recorder and returns once it hears the bus: SCENARIO, repeated until then, is the
  /// first event.
  /// @throws StartupError when there is something at `path`, or the recorder cannot run, write, or
  ///         hear.
  LogKeeper(const ProcessSpec& recorder, const std::string& path, const RestartPolicy& policy,
            trial::Announcer& announcer, const bus::Clock& clock);
  LogKeeper(const LogKeeper&) = delete;
  LogKeeper& operator=(const LogKeeper&) = delete;
  LogKeeper(LogKeeper&&) = delete;
  LogKeeper& operator=(LogKeeper&&) = delete;
  ~LogKeeper() = default;

  /// As Supervisor::poll().
  std::vector<SupervisorEvent> poll(Supervisor::Nanoseconds monotonic_ns);
  /// Whether `bytes`, published last of all, have come into the file.
  [[nodiscard]] bool holds(std::span<const std::uint8_t> bytes) const;
  /// Ends the recorder, which first writes what it has heard; what had to be killed. The file is
  /// whole in either case, unless what a killed one left cannot be cut off: then it is not good.
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
  std::optional<Time> last_before_;  ///< while the first event after a restart is awaited
  std::uint64_t size_before_bytes_ = 0;
  bool is_spoilt_ = false;  ///< gone or unreadable at a restart, or its torn end not cut off
};

}  // namespace vantage::tools
