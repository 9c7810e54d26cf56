#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "logs/edit/edit.hpp"
#include "logs/record/log_writer.hpp"
#include "tools/command_line/runner.hpp"

namespace vantage::tools {

// Each function adds its subcommands to `vantage log`.
void add_log_inspect_commands(CLI::App& log, Runner& run);  ///< subcommands info and check
void add_log_edit_commands(CLI::App& log, Runner& run);     ///< subcommands for editing
void add_log_replay_command(CLI::App& log, Runner& run);
void add_log_export_command(CLI::App& log, Runner& run);
void add_log_metrics_commands(CLI::App& log, Runner& run);  ///< subcommands metrics and plot
void add_log_fit_motion_command(CLI::App& log, Runner& run);
void add_log_fit_ranges_command(CLI::App& log, Runner& run);
void add_log_import_command(CLI::App& log, Runner& run);
void add_log_localize_command(CLI::App& log, Runner& run);
void add_log_fit_sensor_command(CLI::App& log, Runner& run);
void add_log_play_command(CLI::App& log, Runner& run);
void add_log_record_command(CLI::App& log, Runner& run);

/// Bytes; maximum message size of `record` and `play` unless the URL sets another one. It is twice
/// the size of LCM's buffer for incomplete messages. All other processes accept 4 MiB.
inline constexpr int kLogMessageBytesMax = 32 << 20;
/// Returns `url`, or the default URL if `url` is empty, with max_message_size=kLogMessageBytesMax.
std::string url_for_log(const std::string& url);

/// Returns a function that shows the progress of `what` on stderr; empty if stderr is not a
/// terminal.
std::function<void(double)> progress_line(const std::string& what);

/// Opens the log at `path`. A log without an index is read completely, with a progress line; SIGINT
/// and SIGTERM end the process during this pass. @throws StartupError if the log cannot be read.
logs::IndexedLog open_log(const std::string& path);
/// Returns the names of a log's channels as text for a sentence; at most 20 names.
std::string channel_names(const logs::LogSurvey& survey);
/// Prints the `expressions` that match no channel of `log`, and the channels of `log`. @throws
/// StartupError if there are expressions and no expression matches.
void require_channels(const logs::IndexedLog& log, const std::vector<std::string>& expressions);

/// Output log, which must differ from all input logs.
class OutputLog {
 public:
  /// @throws StartupError if `path` is one of `inputs`, exists (without `force`), or cannot be
  ///         written.
  OutputLog(const std::string& path, const std::vector<std::string>& inputs, bool force);
  logs::EventSink sink();
  /// Writes buffered events and closes the file. Returns an error with the file's name, or "".
  std::string finish();
  [[nodiscard]] std::int64_t events() const { return writer_.events(); }

 private:
  static std::string checked(const std::string& path, const std::vector<std::string>& inputs,
                             bool force);
  logs::LogWriter writer_;
};

}  // namespace vantage::tools
