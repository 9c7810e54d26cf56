#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bus/node/air_budget.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Model of a radio network between robots in a trial in virtual time (network.simulation).
///
/// Every robot is a host. Messages of a robot reach its own processes always, and other robots over
/// its link. A link with a rate has a queue of 0.1 s, at least eight frames. A frame that finds the
/// queue full is dropped, and its message is lost. Queueing does not delay messages. Each frame of
/// 1480 bytes is lost with the given probability, independently per receiving host; a message with
/// a lost frame is lost. All other messages (mocap, simulator, operator) reach every robot. The
/// losses depend only on the seed.
class SimulatedNetwork : public bus::HubNetwork {
 public:
  /// `scenario` is only read by this call. `clock` must outlive this object.
  SimulatedNetwork(const scenario::Scenario& scenario, const bus::Clock& clock);

  void send(std::string_view channel, std::size_t bytes, bus::Reach reach) override;
  bool arrives_at(const std::string& host) override;

  /// Returns the bytes that all robots sent to other hosts by kind of channel ("PLAN"), headers
  /// included, dropped messages excluded.
  [[nodiscard]] std::vector<models::NamedCount> bytes_sent() const;

 private:
  scenario::SimulatedNetworkSpec spec_;
  std::uint64_t seed_;
  const bus::Clock& clock_;
  bus::AirBudget channels_;                           ///< names of the robots
  std::map<std::string, Time, std::less<>> free_at_;  ///< by robot: time at which its link is free
  std::string sender_;      ///< sender of the present message; empty: no robot
  bool is_on_air_ = false;  ///< the present message leaves its robot
  double survival_ = 1.0;   ///< probability that the present message arrives at one host
  std::uint64_t messages_ = 0;
  std::map<std::string, std::int64_t, std::less<>> bytes_sent_;  ///< by kind of channel
};

}  // namespace vantage::trial
