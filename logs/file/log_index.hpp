#pragma once

#include <functional>
#include <optional>
#include <string>

#include "logs/file/log_scan.hpp"
#include "logs/file/log_survey.hpp"
#include "logs/file/mapped_file.hpp"

namespace vantage::logs {

/// A log and its survey, which is kept beside it (LOG.index) so that the next opening, and every
/// seek, needs no pass over the log. The index holds for the very bytes it was made from: a log
/// that has another size, another time of change or other bytes at its ends is surveyed anew. A
/// folder that cannot be written to is no error; then each opening takes its pass. An index that is
/// damaged, of another version or made up is ignored and written anew.
class IndexedLog {
 public:
  /// @throws StartupError when `path` cannot be read.
  explicit IndexedLog(const std::string& path, const std::function<void(double)>& progress = {});

  [[nodiscard]] const LogSurvey& survey() const { return survey_; }
  [[nodiscard]] const std::string& path() const { return file_.path(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return file_.bytes(); }
  /// True when the index beside the log was used.
  [[nodiscard]] bool was_indexed() const { return was_indexed_; }

  /// The events from the beginning, or from the first one that is not earlier than `from`. Spans
  /// and names in them live as long as this object.
  [[nodiscard]] LogScan scan() const;
  [[nodiscard]] LogScan scan_from(Time from) const;

 private:
  MappedFile file_;
  LogSurvey survey_;
  bool was_indexed_ = false;
};

/// The index of `log_path` as it lies beside it, when there is one and it fits the log.
std::optional<LogSurvey> load_index(const std::string& log_path, std::span<const std::uint8_t> log);
/// False when it could not be written.
bool save_index(const std::string& log_path, std::span<const std::uint8_t> log,
                const LogSurvey& survey);

}  // namespace vantage::logs
