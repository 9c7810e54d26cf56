#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "bus/node/clock.hpp"
#include "core/time.hpp"
#include "logs/foxglove/stream.hpp"

namespace vantage::tools {

/// Storage of the past records that a new viewer needs for charts, marks and paths:
/// - all records of the scenario, of the team, of plans and of events;
/// - at most one record per second of each vehicle and process, and of the targets' states;
/// - the positions of all bodies five times per second.
/// The size is bounded; the oldest records are removed first. With Forwarding::kRecords, all
/// records are passed on to the Sink `audience`. With kWantsOnly, only audience.wants() is called,
/// so that `audience` knows every topic. One thread writes; any thread may read.
class History : public logs::foxglove::Sink {
 public:
  enum class Forwarding { kRecords, kWantsOnly };

  /// @param clock  clock for the periods of the stored records
  History(const bus::Clock& clock, logs::foxglove::Sink& audience, Forwarding forwarding,
          std::size_t bytes_max)
      : clock_(clock), audience_(audience), forwarding_(forwarding), bytes_max_(bytes_max) {}

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override;
  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override;
  void name_type(const std::string& topic, const std::string& type) override {
    audience_.name_type(topic, type);
  }

  /// Returns a JSON list of [topic, utime, content], oldest first. Positions of bodies are on topic
  /// "/paths": {body: [x_m, y_m, z_m]}.
  [[nodiscard]] std::string text() const;

 private:
  void keep(const std::string& topic, Time time, const logs::foxglove::Json& content);

  const bus::Clock& clock_;
  logs::foxglove::Sink& audience_;
  const Forwarding forwarding_;
  const std::size_t bytes_max_;
  bool is_due_ = false;                  ///< true: the record of the last wants() is stored
  bool audience_wants_ = false;          ///< true: the record of the last wants() is passed on
  std::map<std::string, Time> written_;  ///< time of the last stored record, by topic
  mutable std::mutex mutex_;             ///< guards all members below
  std::deque<std::string> records_;
  std::size_t bytes_ = 0;
};

}  // namespace vantage::tools
