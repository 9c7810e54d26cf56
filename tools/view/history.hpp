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

/// Writes down what somebody who comes later needs for charts, marks and the ways of bodies: the
/// numbers of the team and of plans, events, at most one record a second of each vehicle and
/// process, and five times a second where every body is. Bounded: the oldest records go first.
/// Passes everything on to another Sink, or only asks that one what it wants, so that it knows
/// every topic. Written by one thread, read by any.
class History : public logs::foxglove::Sink {
 public:
  enum class Audience { kHears, kIsAskedOnly };

  /// @param clock  when records are heard
  History(const bus::Clock& clock, logs::foxglove::Sink& audience, Audience how,
          std::size_t bytes_max)
      : clock_(clock), audience_(audience), how_(how), bytes_max_(bytes_max) {}

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override;
  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override;
  void name_type(const std::string& topic, const std::string& type) override {
    audience_.name_type(topic, type);
  }

  /// A JSON list of [topic, utime, content], oldest first. Where bodies are is on topic "/ways":
  /// {body: [x_m, y_m, z_m]}.
  [[nodiscard]] std::string text() const;

 private:
  void keep(const std::string& topic, Time time, const logs::foxglove::Json& content);

  const bus::Clock& clock_;
  logs::foxglove::Sink& audience_;
  const Audience how_;
  const std::size_t bytes_max_;
  bool is_due_ = false;                  ///< the record that was just asked for is kept
  bool audience_wants_ = false;          ///< it is passed on
  std::map<std::string, Time> written_;  ///< when last
  mutable std::mutex mutex_;             ///< of the rest
  std::deque<std::string> records_;
  std::size_t bytes_ = 0;
};

}  // namespace vantage::tools
