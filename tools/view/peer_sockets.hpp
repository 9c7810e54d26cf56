#pragma once

#include <map>
#include <optional>

#include "tools/view/connection_table.hpp"

namespace vantage::tools {

/// Returns the remote end of a connected socket if its own port is `port`; nullopt for any other
/// descriptor.
std::optional<ConnectionTable::Peer> peer_at(int descriptor, int port);

/// Returns this process's connections to `port` with their descriptors. Reads them from /proc, as
/// civetweb reports a connection only after its request has arrived.
std::map<ConnectionTable::Peer, int> connections_to(int port);

}  // namespace vantage::tools
