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

/// Listening time; supervisors publish once per second, all other processes more often.
inline constexpr Duration kListenToNeighbours = std::chrono::milliseconds(1'200);

/// Names of the channels on which messages were received.
struct HeardChannels {
  std::set<std::string> accepted;
  std::set<std::string> unverified;  ///< refused: no valid signature for that channel
};

/// Returns the names of all channels on which messages are received within `duration`, or until
/// `stop`. `authenticator` decides by `clock` which messages are accepted; nullptr: all. Do not use
/// the transport afterwards. Keeps at most 10,000 names of either kind.
HeardChannels hear_channels(bus::Transport& transport, Duration duration,
                            const std::function<bool()>& stop,
                            bus::auth::Authenticator* authenticator, const bus::Clock& clock);
/// As above, accepts everything and returns only the names.
std::set<std::string> hear_channels(bus::Transport& transport, Duration duration,
                                    const std::function<bool()>& stop);

/// Returns the reasons why `vantage up` as `host` of the scenario (empty: all of it) must not start
/// while `channels` are in use, one sentence each. Reasons are the same host's supervisor, that of
/// a host outside this trial, a simulator or vehicles that it would start a second time, and
/// unknown vehicles. Other hosts of the trial are allowed.
std::vector<std::string> rivals_of_up(const scenario::Scenario& scenario, const std::string& host,
                                      const std::set<std::string>& channels);

/// Returns the reasons why a log must not be played there: active vehicles, supervisors or a
/// simulator.
std::vector<std::string> rivals_of_play(const std::set<std::string>& channels);

}  // namespace vantage::trial
