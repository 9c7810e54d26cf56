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

// Each adds its subcommands to `vantage log`.
void add_log_look_commands(CLI::App& log, Runner& run);  ///< info, check
void add_log_edit_commands(CLI::App& log, Runner& run);  ///< repair, slice, filter, rename, merge
void add_log_replay_command(CLI::App& log, Runner& run);
void add_log_export_command(CLI::App& log, Runner& run);
void add_log_metrics_commands(CLI::App& log, Runner& run);  ///< metrics, plot
void add_log_fit_motion_command(CLI::App& log, Runner& run);
void add_log_fit_ranges_command(CLI::App& log, Runner& run);
void add_log_play_command(CLI::App& log, Runner& run);
void add_log_record_command(CLI::App& log, Runner& run);

/// Largest message that `record` and `play` carry unless the URL says otherwise: twice what LCM
/// keeps of unfinished messages. The other processes of the stack take 4 MiB.
inline constexpr int kLogMessageBytesMax = 32 << 20;
/// Returns `url`, or the default one when it is empty, with that max_message_size.
std::string url_for_log(const std::string& url);

/// A progress line on stderr named `what` when that is a terminal, else nothing.
std::function<void(double)> progress_line(const std::string& what);

/// The log at `path`, read through with a progress line when it has no index; SIGINT and SIGTERM
/// end the process meanwhile. @throws StartupError when it cannot be read.
logs::IndexedLog open_log(const std::string& path);
/// Its channels, for a sentence: the first 20.
std::string channel_names(const logs::LogSurvey& survey);
/// Says which of `expressions` fit no channel of `log`, and which it has. @throws StartupError when
/// none fits any (and there are some).
void require_channels(const logs::IndexedLog& log, const std::vector<std::string>& expressions);

/// A log to be written, never one of `inputs`.
class OutputLog {
 public:
  /// @throws StartupError when `path` is one of `inputs`, exists (without `force`), or cannot be
  ///         written.
  OutputLog(const std::string& path, const std::vector<std::string>& inputs, bool force);
  logs::EventSink sink();
  /// Writes all; why it could not, with the file's name, or empty.
  std::string finish();
  [[nodiscard]] std::int64_t events() const { return writer_.events(); }

 private:
  static std::string checked(const std::string& path, const std::vector<std::string>& inputs,
                             bool force);
  logs::LogWriter writer_;
};

}  // namespace vantage::tools
