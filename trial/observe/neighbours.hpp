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

// Who is alive on a network before this process says anything there. A second simulation beside a
// flight, or an old log, must not be taken for it.

namespace vantage::trial {

/// Supervisors speak once a second, everybody else more often.
inline constexpr Duration kListenToNeighbours = std::chrono::milliseconds(1'200);

/// The names of channels on which something was received.
struct HeardChannels {
  std::set<std::string> accepted;
  std::set<std::string> unverified;  ///< refused: not signed, or not by who may publish there
};

/// Returns the names of all channels on which something is received within `duration`, or until
/// `stop`. `authenticator` decides by `clock` what is accepted; nullptr: everything. The transport
/// is not to be used any more after that. Keeps at most 10,000 names of either kind.
HeardChannels hear_channels(bus::Transport& transport, Duration duration,
                            const std::function<bool()>& stop,
                            bus::auth::Authenticator* authenticator, const bus::Clock& clock);
/// As above where everything is accepted: the names alone.
std::set<std::string> hear_channels(bus::Transport& transport, Duration duration,
                                    const std::function<bool()>& stop);

/// Why `vantage up` as `host` of the scenario (empty: all of it) must not start beside those who
/// speak on `channels`, one sentence each: the same host's supervisor, that of a host that is not
/// of this trial, a simulator or vehicles that it would start a second time, or that it does not
/// know. Other hosts of the trial are welcome.
std::vector<std::string> rivals_of_up(const scenario::Scenario& scenario, const std::string& host,
                                      const std::set<std::string>& channels);

/// Why a log must not be played there: vehicles, supervisors or a simulator are alive.
std::vector<std::string> rivals_of_play(const std::set<std::string>& channels);

}  // namespace vantage::trial
