#include "test/integration/processes.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <linux/filter.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace vantage::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> arguments_of(const fs::path& process) {
  std::ifstream file(process / "cmdline", std::ios::binary);
  std::vector<std::string> out;
  for (std::string argument; std::getline(file, argument, '\0');) {
    out.push_back(argument);
  }
  return out;
}

std::string network_of(const fs::path& process) {
  std::error_code error;
  return fs::read_symlink(process / "ns" / "net", error).string();
}

/// Attaches or removes a filter that drops datagrams from or to `port`. A filter of a datagram
/// socket sees each packet from its UDP header on: source port, destination port.
bool filter_socket(int fd, int port, bool is_cut) {
  if (!is_cut) {
    const int nothing = 0;
    return ::setsockopt(fd, SOL_SOCKET, SO_DETACH_FILTER, &nothing, sizeof nothing) == 0 ||
           errno == ENOENT;
  }
  std::array<sock_filter, 6> code{{
      {BPF_LD | BPF_H | BPF_ABS, 0, 0, 0},
      {BPF_JMP | BPF_JEQ | BPF_K, 2, 0, static_cast<__u32>(port)},
      {BPF_LD | BPF_H | BPF_ABS, 0, 0, 2},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, static_cast<__u32>(port)},
      {BPF_RET | BPF_K, 0, 0, 0},
      {BPF_RET | BPF_K, 0, 0, 0xFFFF},
  }};
  const sock_fprog program{static_cast<unsigned short>(code.size()), code.data()};
  return ::setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) == 0;
}

bool filter_process(pid_t process, int port, bool is_cut) {
  const auto pidfd = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
  if (pidfd < 0) {
    return false;
  }
  bool is_done = true;
  std::error_code error;
  for (const auto& entry :
       fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", error)) {
    if (fs::read_symlink(entry.path(), error).string().rfind("socket:", 0) != 0) {
      continue;
    }
    const auto fd = static_cast<int>(
        ::syscall(SYS_pidfd_getfd, pidfd, std::stoi(entry.path().filename().string()), 0));
    int type = 0;
    int family = 0;
    socklen_t size = sizeof type;
    if (fd < 0) {
      is_done = false;
    } else if (::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM &&
               ::getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &family, &size) == 0 && family == AF_INET) {
      is_done = filter_socket(fd, port, is_cut) && is_done;
    }
    ::close(fd);
  }
  ::close(pidfd);
  return is_done && !error;
}

}  // namespace

std::vector<pid_t> find_processes(const std::string& program,
                                  const std::vector<std::string>& arguments) {
  std::vector<pid_t> out;
  const std::string ours = network_of("/proc/self");
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) {
      continue;
    }
    const std::vector<std::string> words = arguments_of(entry.path());
    const bool has_arguments =
        arguments.empty() ||
        std::search(words.begin(), words.end(), arguments.begin(), arguments.end()) != words.end();
    if (!words.empty() && fs::path(words.front()).filename() == program && has_arguments &&
        network_of(entry.path()) == ours) {
      out.push_back(std::stoi(name));
    }
  }
  return out;
}

bool cut_udp_link(pid_t one, pid_t other, int port, bool is_cut) {
  const bool first = filter_process(one, port, is_cut);
  return filter_process(other, port, is_cut) && first;
}

}  // namespace vantage::test
