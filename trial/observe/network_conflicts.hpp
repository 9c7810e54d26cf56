#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "bus/auth/authenticator.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

// Detection of other systems on a network before this process publishes there, so that a second
// simulation or a replayed log is not mistaken for a running flight.

namespace vantage::trial {

/// Duration of the detection. Supervisors publish once per second, all other processes more often.
inline constexpr Duration kListenTime = std::chrono::milliseconds(1'200);

/// Names of the channels on which messages were received.
struct ActiveChannels {
  std::set<std::string> accepted;
  std::set<std::string>
      unverified;  ///< channels of which messages were refused because they have no valid signature
};

/// Returns the names of all channels on which messages are received within `duration`, or until
/// `stop` returns true. `authenticator` decides, with the time of `clock`, which messages are
/// accepted; nullptr: all are. The transport must not be used afterwards. Stores at most 10,000
/// names of each kind.
ActiveChannels find_active_channels(bus::Transport& transport, Duration duration,
                                    const std::function<bool()>& stop,
                                    bus::auth::Authenticator* authenticator,
                                    const bus::Clock& clock);
/// Returns the names of all channels on which messages are received, without checks of signatures.
std::set<std::string> find_active_channels(bus::Transport& transport, Duration duration,
                                           const std::function<bool()>& stop);

/// Returns the reasons why `vantage up` for `host` (empty: all parts of the scenario) must not
/// start while `channels` are in use, one sentence each. Reasons are: a supervisor of the same host
/// or of a host outside this trial, a simulator or vehicles that would run twice, and unknown
/// vehicles. Supervisors of other hosts of the trial are not a reason.
std::vector<std::string> conflicts_with_up(const scenario::Scenario& scenario,
                                           const std::string& host,
                                           const std::set<std::string>& channels);

/// Returns the reasons why a log must not be played on a network with these channels: active
/// vehicles, supervisors or a simulator.
std::vector<std::string> conflicts_with_play(const std::set<std::string>& channels);

}  // namespace vantage::trial
