#pragma once

#include <fstream>
#include <string>
#include <string_view>

namespace vantage::logs {

/// A table that is being written. It ends with a complete line, even if the disk is full.
class CsvFile {
 public:
  /// @throws StartupError "PATH: cannot be written: REASON" if the file cannot be created.
  CsvFile(std::string path, std::string_view header);

  /// Returns false if the lines could not be written; failure() then has the reason.
  bool write(std::string_view lines);
  /// Closes the file. After a failed write, the file is cut to its last complete line.
  void close();
  /// Returns "PATH: cannot be written: REASON"; empty if everything was written.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  void note_failure();

  std::string path_;
  std::ofstream out_;
  std::string failure_;
};

/// Returns `text` as a cell, with quotes if needed (RFC 4180).
std::string csv_cell(std::string_view text);

}  // namespace vantage::logs
