#pragma once

#include <functional>
#include <optional>
#include <string>

#include "logs/file/log_scan.hpp"
#include "logs/file/log_survey.hpp"
#include "logs/file/mapped_file.hpp"

namespace vantage::logs {

/// A log and its survey, which is stored next to the log as LOG.index. Later openings and seeks
/// then need no pass over the log. An index is valid only for an unchanged log: if the log's size,
/// its time of modification or the bytes at its ends differ, the log is surveyed again. An index
/// that is damaged, forged or of another version is ignored and replaced. In a read-only folder no
/// index is stored, so each opening reads the log.
class IndexedLog {
 public:
  /// @throws StartupError when `path` cannot be read.
  explicit IndexedLog(const std::string& path, const std::function<void(double)>& progress = {});

  [[nodiscard]] const LogSurvey& survey() const { return survey_; }
  [[nodiscard]] const std::string& path() const { return file_.path(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return file_.bytes(); }
  /// True if a stored index was used.
  [[nodiscard]] bool was_indexed() const { return was_indexed_; }

  /// Returns a scan from the beginning, or from the first event with time ≥ `from`. Spans and names
  /// of its events are valid during the lifetime of this object.
  [[nodiscard]] LogScan scan() const;
  [[nodiscard]] LogScan scan_from(Time from) const;

 private:
  MappedFile file_;
  LogSurvey survey_;
  bool was_indexed_ = false;
};

/// Returns the stored index of `log_path`; nullopt if there is none or if it does not match `log`.
std::optional<LogSurvey> load_index(const std::string& log_path, std::span<const std::uint8_t> log);
/// Writes the index next to the log. Returns false if that fails.
bool save_index(const std::string& log_path, std::span<const std::uint8_t> log,
                const LogSurvey& survey);

}  // namespace vantage::logs
