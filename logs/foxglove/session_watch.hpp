#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs::foxglove {

/// Detector of a new session (run of a trial) from the SCENARIO messages, which each host of a
/// trial publishes every 5 s. A message of an unknown run begins a session if its scenario differs,
/// or if every known publisher is overdue. Otherwise the unknown run is a candidate. As soon as a
/// known publisher sends again, candidates become known: they are other hosts of the same trial.
class SessionWatch {
 public:
  static constexpr Duration kOverdue = std::chrono::milliseconds(5'600);

  /// Returns true if this message begins a session; the first message does.
  bool on(const models::ScenarioNotice& notice, Time received_at);

 private:
  static constexpr std::size_t kPublishersMax = 64;

  std::string yaml_;
  std::map<std::int64_t, Time> known_;  ///< time of each publisher's last message, by run id
  std::map<std::int64_t, Time> candidates_;
};

}  // namespace vantage::logs::foxglove
