#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace vantage::tools {

/// Where the page of a browser that was started to record hands over what it has made. Only who has
/// the key may. Thread-safe.
class RecordingDesk {
 public:
  /// @param on_progress  hears the share that is done, on the server's threads
  RecordingDesk(std::string key, std::function<void(double)> on_progress)
      : key_(std::move(key)), on_progress_(std::move(on_progress)) {}

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] bool is_key(std::string_view key) const { return key == key_; }

  void tell_progress(double share) { on_progress_(share); }
  void take(std::string video);
  void fail(std::string why);

  /// True once there is a video or a reason why there is none.
  [[nodiscard]] bool is_over() const;
  /// Empty: there is none.
  [[nodiscard]] std::string video() const;
  [[nodiscard]] std::string failure() const;

 private:
  const std::string key_;
  const std::function<void(double)> on_progress_;
  mutable std::mutex mutex_;  ///< of the rest
  std::string video_;
  std::string failure_;
};

}  // namespace vantage::tools
