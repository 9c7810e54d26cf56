#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace vantage::tools {

/// Receiver of the video from the page of a recording browser. The page must send the key.
/// Thread-safe.
class RecordingReceiver {
 public:
  /// @param on_progress  called with the completed share in [0, 1] on the server's threads
  RecordingReceiver(std::string key, std::function<void(double)> on_progress)
      : key_(std::move(key)), on_progress_(std::move(on_progress)) {}

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] bool is_key(std::string_view key) const { return key == key_; }

  void report_progress(double share) { on_progress_(share); }
  void take(std::string video);
  void fail(std::string why);

  /// True once a video or a failure was received.
  [[nodiscard]] bool is_over() const;
  /// Returns the video; empty if there is none.
  [[nodiscard]] std::string video() const;
  [[nodiscard]] std::string failure() const;

 private:
  const std::string key_;
  const std::function<void(double)> on_progress_;
  mutable std::mutex mutex_;  ///< guards all members below
  std::string video_;
  std::string failure_;
};

}  // namespace vantage::tools
