#include "bus/node/process_usage.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <iterator>

#include <sys/resource.h>
#include <unistd.h>

namespace vantage::bus {
namespace {

// Fields of /proc/PID/stat counted from the one after the name (proc(5): state is field 3).
constexpr std::size_t kUserTicks = 11;
constexpr std::size_t kSystemTicks = 12;
constexpr std::size_t kResidentPages = 21;
constexpr std::size_t kFieldsNeeded = 22;

std::int64_t micros(const timeval& time) {
  return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
}

}  // namespace

std::optional<ProcessUsage> usage_from_stat(std::string_view stat, std::int64_t ticks_per_s,
                                            std::int64_t page_bytes) {
  const std::size_t name_end = stat.rfind(')');  // a name may hold anything, brackets too
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
    if (i > 0) {  // the state is a letter
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
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string stat{std::istreambuf_iterator<char>(file), {}};
  return usage_from_stat(stat, ::sysconf(_SC_CLK_TCK), ::sysconf(_SC_PAGESIZE));
}

std::vector<models::NamedCount> usage_counters() {
  rusage own{};
  ::getrusage(RUSAGE_SELF, &own);
  const auto now = usage_of(::getpid()).value_or(ProcessUsage{});
  constexpr std::int64_t kKibibyte = 1024;
  return {{"process.cpu_us", micros(own.ru_utime) + micros(own.ru_stime)},
          {"process.memory_bytes", now.memory_bytes},
          {"process.memory_most_bytes", own.ru_maxrss * kKibibyte}};
}

}  // namespace vantage::bus
