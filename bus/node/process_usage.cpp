#include "bus/node/process_usage.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace vantage::bus {
namespace {

// Indices of fields of /proc/PID/stat. The state, which follows the name, has index 0 (field 3 in
// proc(5)).
constexpr std::size_t kUserTicks = 11;
constexpr std::size_t kSystemTicks = 12;
constexpr std::size_t kResidentPages = 21;
constexpr std::size_t kFieldsNeeded = 22;

std::int64_t micros(const timeval& time) {
  return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
}

/// Returns the content of the file; empty when it cannot be read.
std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::optional<ProcessUsage> usage_from_stat(std::string_view stat, std::int64_t ticks_per_s,
                                            std::int64_t page_bytes) {
  const std::size_t name_end = stat.rfind(')');  // a name may contain any character, also ')'
  if (name_end == std::string_view::npos || ticks_per_s <= 0) {
    return std::nullopt;
  }
  std::string_view rest = stat.substr(name_end + 1);
  std::array<std::int64_t, kFieldsNeeded> fields{};
  for (std::size_t i = 0; i < kFieldsNeeded; ++i) {
    const std::size_t begin = rest.find_first_not_of(' ');
    if (begin == std::string_view::npos) {
      return std::nullopt;
    }
    rest.remove_prefix(begin);
    const std::size_t size = std::min(rest.find(' '), rest.size());
    if (i > 0) {  // field 0, the state, is a letter
      const auto parsed = std::from_chars(rest.data(), rest.data() + size, fields[i]);
      if (parsed.ptr != rest.data() + size) {
        return std::nullopt;
      }
    }
    rest.remove_prefix(size);
  }
  ProcessUsage usage;
  const double ticks = static_cast<double>(fields[kUserTicks] + fields[kSystemTicks]);
  usage.cpu_us = static_cast<std::int64_t>(ticks * 1e6 / static_cast<double>(ticks_per_s));
  usage.memory_bytes = fields[kResidentPages] * page_bytes;
  return usage;
}

std::optional<ProcessUsage> usage_of(int pid) {
  return usage_from_stat(text_of("/proc/" + std::to_string(pid) + "/stat"), ::sysconf(_SC_CLK_TCK),
                         ::sysconf(_SC_PAGESIZE));
}

// The text has three numbers: run time and waiting time in ns, and the number of time slices. All
// are 0 if the kernel does not count them. A thread may wait before its first time slice.
std::optional<std::int64_t> waited_us_from_schedstat(std::string_view schedstat) {
  std::array<std::int64_t, 3> fields{};
  for (std::int64_t& field : fields) {
    schedstat.remove_prefix(std::min(schedstat.find_first_not_of(' '), schedstat.size()));
    const auto parsed =
        std::from_chars(schedstat.data(), schedstat.data() + schedstat.size(), field);
    if (parsed.ec != std::errc()) {
      return std::nullopt;
    }
    schedstat.remove_prefix(static_cast<std::size_t>(parsed.ptr - schedstat.data()));
  }
  return fields[1] > 0 || fields[2] > 0 ? std::optional(fields[1] / 1'000) : std::nullopt;
}

std::optional<std::int64_t> waited_us_of(int pid) {
  std::optional<std::int64_t> sum_us;
  std::error_code gone;
  const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
  for (std::filesystem::directory_iterator task(tasks, gone), end; task != end;
       task.increment(gone)) {
    const auto waited_us = waited_us_from_schedstat(text_of(task->path() / "schedstat"));
    if (waited_us) {  // otherwise the thread has just ended
      sum_us = sum_us.value_or(0) + *waited_us;
    }
  }
  return sum_us;
}

ThreadWait::ThreadWait()
    : descriptor_(::open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC)) {}

ThreadWait::~ThreadWait() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

std::optional<std::int64_t> ThreadWait::waited_us() const {
  std::array<char, 128> text{};
  const ssize_t got = descriptor_ < 0 ? -1 : ::pread(descriptor_, text.data(), text.size(), 0);
  return got <= 0 ? std::nullopt
                  : waited_us_from_schedstat({text.data(), static_cast<std::size_t>(got)});
}

std::vector<models::NamedCount> usage_counters() {
  rusage own{};
  ::getrusage(RUSAGE_SELF, &own);
  const auto now = usage_of(::getpid()).value_or(ProcessUsage{});
  constexpr std::int64_t kKibibyte = 1024;
  std::vector<models::NamedCount> out = {
      {"process.cpu_us", micros(own.ru_utime) + micros(own.ru_stime)},
      {"process.memory_bytes", now.memory_bytes},
      {"process.memory_most_bytes", own.ru_maxrss * kKibibyte}};
  if (const auto waited_us = waited_us_of(::getpid())) {
    out.push_back({"process.waited_us", *waited_us});
  }
  return out;
}

}  // namespace vantage::bus
