#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace vantage::test {

/// Returns the processes of this network namespace with the program name `program` (without folder)
/// and `arguments` in sequence among their arguments (empty: any). Reads /proc.
std::vector<pid_t> find_processes(const std::string& program,
                                  const std::vector<std::string>& arguments);

/// Cuts or restores the UDP link between two processes of this host, one of which uses `port`. A
/// filter on every UDP socket of both drops datagrams from or to that port; the processes notice
/// only the silence. Returns false if a socket cannot be obtained (pidfd_getfd needs root).
bool cut_udp_link(pid_t one, pid_t other, int port, bool is_cut);

}  // namespace vantage::test
