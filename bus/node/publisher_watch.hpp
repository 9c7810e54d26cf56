#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::bus {

/// Detector of two processes that publish on one channel, such as our sensor and a user's detector.
/// Receivers then use only one of the two, which may change.
///
/// A restarted process never publishes with its earlier run id again, so the order of run ids A, B,
/// A, B, A, B shows two publishers. A shorter order can be one delayed message of a process that
/// was restarted. Channels on which several processes may publish are ignored. Stores at most
/// 16,384 channels, and eight run ids of each.
class PublisherWatch {
 public:
  /// Adds a message with the run id of its publisher. Returns true at the message that shows the
  /// second publisher of a channel, once per channel.
  bool on_run(std::string_view channel, std::int64_t run_id);
  /// Returns the channels with two publishers, by name.
  [[nodiscard]] std::vector<std::string> contested() const;

 private:
  struct Runs {
    std::int64_t current = 0;
    std::vector<std::int64_t> earlier;
    int returns = 0;  ///< number of changes to an earlier run since the newest run
    bool is_contested = false;
  };
  std::map<std::string, Runs, std::less<>> runs_;
};

/// Returns the run id of a vantage message, which follows the fingerprint and the time; 0 if the
/// message is too short.
std::int64_t run_id_of(std::span<const std::uint8_t> message);

}  // namespace vantage::bus
