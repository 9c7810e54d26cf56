#include "core/child.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/process.hpp"

namespace vantage {
namespace {

// Executed in the forked child, so it must not allocate or lock.
[[noreturn]] void become(const char* const* arguments, const char* const* environment,
                         int report_fd, const ChildOptions& options, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, options.end_signal);
  if (::getppid() != parent) {
    ::_exit(127);
  }
  ::signal(SIGPIPE, SIG_DFL);
  if (options.blocks_stop_signals) {
    sigset_t stop_signals;
    ::sigemptyset(&stop_signals);
    for (const int signal : kStopSignals) {
      ::sigaddset(&stop_signals, signal);
    }
    ::sigprocmask(SIG_BLOCK, &stop_signals, nullptr);
  }
  for (const int descriptor : options.keep_open) {
    ::fcntl(descriptor, F_SETFD, 0);
  }
  if (options.output >= 0) {
    ::dup2(options.output, STDOUT_FILENO);
    ::dup2(options.output, STDERR_FILENO);
  }
  if (options.folder.empty() || ::chdir(options.folder.c_str()) == 0) {
    ::execvpe(arguments[0], const_cast<char* const*>(arguments),  // NOLINT: exec only reads
              const_cast<char* const*>(environment));             // NOLINT: exec only reads
  }
  const int error = errno;
  [[maybe_unused]] const auto written = ::write(report_fd, &error, sizeof(error));
  ::_exit(127);
}

// Returns this process's environment with the variables of `own` added or replaced; ends with null.
std::vector<const char*> environment_with(const std::vector<std::string>& own) {
  std::vector<const char*> out;
  for (char** each = ::environ; *each != nullptr; ++each) {
    const std::string_view entry(*each);
    const bool is_replaced = std::any_of(own.begin(), own.end(), [&](const std::string& other) {
      return entry.substr(0, entry.find('=')) == other.substr(0, other.find('='));
    });
    if (!is_replaced) {
      out.push_back(*each);
    }
  }
  for (const std::string& entry : own) {
    out.push_back(entry.c_str());
  }
  out.push_back(nullptr);
  return out;
}

}  // namespace

std::string ChildExit::describe() const {
  return signal != 0 ? "signal " + std::to_string(signal) : "exit " + std::to_string(code);
}

Result<Child> Child::start(const std::vector<std::string>& arguments, const ChildOptions& options) {
  require(!arguments.empty(), "the name of the process to start is missing");
  std::vector<const char*> pointers;
  for (const std::string& argument : arguments) {
    pointers.push_back(argument.c_str());
  }
  pointers.push_back(nullptr);
  const std::vector<const char*> environment = environment_with(options.environment);
  // A successful exec closes the write end. If exec fails, the child writes errno to it.
  std::array<int, 2> pipe_fds{};
  if (::pipe2(pipe_fds.data(), O_CLOEXEC) != 0) {
    return Error{std::string("pipe: ") + std::strerror(errno)};
  }
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) {
    become(pointers.data(), environment.data(), pipe_fds[1], options, parent);
  }
  ::close(pipe_fds[1]);
  int error = pid < 0 ? errno : 0;
  if (pid > 0 && ::read(pipe_fds[0], &error, sizeof(error)) > 0) {
    ::waitpid(pid, nullptr, 0);
  }
  ::close(pipe_fds[0]);
  if (error != 0) {
    return Error{arguments[0] + ": " + std::strerror(error)};
  }
  // glibc 2.36 declares pidfd_open() without extern "C", so C++ cannot link it.
  return Child(pid, static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      pidfd_(std::exchange(other.pidfd_, -1)),
      exit_(other.exit_) {}

Child& Child::operator=(Child&& other) noexcept {
  if (this != &other) {
    end();
    pid_ = std::exchange(other.pid_, -1);
    pidfd_ = std::exchange(other.pidfd_, -1);
    exit_ = other.exit_;
  }
  return *this;
}

Child::~Child() { end(); }

void Child::end() {
  if (pid_ > 0 && !exit_) {
    ::kill(-pid_, SIGKILL);  // kill the group, so that descendants (such as a browser's) end too
    send(SIGKILL);           // in case the child has left its group
    ::waitpid(pid_, nullptr, 0);
  }
  if (pidfd_ >= 0) {
    ::close(pidfd_);
  }
}

std::optional<ChildExit> Child::wait(std::chrono::milliseconds timeout) {
  if (exit_ || pid_ <= 0) {
    return exit_;
  }
  pollfd ready{pidfd_, POLLIN, 0};
  ::poll(&ready, 1, static_cast<int>(timeout.count()));
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) == pid_) {
    exit_ =
        WIFSIGNALED(status) ? ChildExit{0, WTERMSIG(status)} : ChildExit{WEXITSTATUS(status), 0};
  }
  return exit_;
}

void Child::send(int signal) {
  if (pid_ > 0 && !exit_) {
    ::kill(pid_, signal);
  }
}

Result<CommandOutput> run_command(const std::vector<std::string>& arguments) {
  std::array<int, 2> pipe_fds{};
  if (::pipe2(pipe_fds.data(), O_CLOEXEC) != 0) {
    return Error{std::string("pipe: ") + std::strerror(errno)};
  }
  Result<Child> child = Child::start(arguments, {pipe_fds[1], "", SIGTERM});
  ::close(pipe_fds[1]);
  CommandOutput answer;
  std::array<char, 4096> part{};
  ssize_t count = 0;
  while ((count = ::read(pipe_fds[0], part.data(), part.size())) > 0 ||
         (count < 0 && errno == EINTR)) {
    answer.text.append(part.data(), static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  }
  ::close(pipe_fds[0]);
  if (!child.ok()) {
    return child.error();
  }
  Child running = std::move(child).value();
  std::optional<ChildExit> ended;
  while (!ended) {
    ended = running.wait(std::chrono::seconds(1));
  }
  answer.exit = *ended;
  return answer;
}

}  // namespace vantage
