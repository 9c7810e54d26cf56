#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace vantage::test {

/// Processes of this network namespace whose program is called `program` (without its folder) and
/// whose arguments have `arguments` among them, one after the other (none: whatever they are).
/// Reads /proc.
std::vector<pid_t> find_processes(const std::string& program,
                                  const std::vector<std::string>& arguments);

/// Cuts or mends the link between two processes of this host that speak by UDP, one of them on
/// `port`: a filter on every UDP socket of both drops what comes from or goes to that port. Neither
/// notices anything but silence. False when a socket cannot be had (pidfd_getfd needs root).
bool cut_udp_link(pid_t one, pid_t other, int port, bool is_cut);

}  // namespace vantage::test
