#include "tools/up/host_board.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

using models::SupervisedPhase;

constexpr double kShareOver_s = 0.5;
constexpr double kMebibyte = 1024.0 * 1024.0;

std::string row_of(const std::string& host, const models::SupervisedProcess& process) {
  return fmt::format("{:<8} {:<14} {:>9} {:>9} {:>8.1f} s {:>6.1f} % {:>7.1f} MiB  {}",
                     readable(host), readable(process.name), name_of(process.phase),
                     process.restarts, process.down_s, 100.0 * process.cpu_share,
                     static_cast<double>(process.memory_bytes) / kMebibyte,
                     readable(process.last_end));
}

}  // namespace

void UsageMeter::fill(const SupervisedStatus& status, const std::optional<Reading>& reading,
                      Time now, models::SupervisedProcess& process) {
  Last& last = last_[status.name];
  if (!reading || status.pid == 0) {
    last = {};
    return;
  }
  const double over_s = to_seconds(now - last.at);
  if (last.pid != status.pid) {
    last = {status.pid, reading->cpu_us, now, 0.0};
  } else if (over_s >= kShareOver_s) {
    const double used_s = static_cast<double>(reading->cpu_us - last.cpu_us) * 1e-6;
    last = {status.pid, reading->cpu_us, now, std::max(0.0, used_s / over_s)};
  }
  process.cpu_share = last.share;
  process.memory_bytes = reading->memory_bytes;
}

HostBoard::HostBoard(const scenario::Scenario& scenario, std::string own, std::int64_t own_run_id,
                     Time start)
    : own_(std::move(own)), own_run_id_(own_run_id) {
  hosts_[own_].at = start;
  for (const scenario::HostSpec& host : scenario.hosts) {
    if (own_ != kOnlyHost) {
      hosts_[host.name].at = start;
    }
  }
  hosts_max_ = hosts_.size() + kOtherHostsMax;
}

std::optional<std::string> HostBoard::on_report(const models::HostReport& report, Time now) {
  if (report.host == own_ && report.stamp.run_id != own_run_id_) {
    return std::exchange(has_duplicate_, true)
               ? std::nullopt
               : std::optional("another `vantage up` is running as host " + own_ +
                               ": all its processes run twice; end one of the two");
  }
  if (!hosts_.contains(report.host) && hosts_.size() >= hosts_max_) {
    return std::nullopt;
  }
  HostState& host = hosts_[report.host];
  const bool was_restarted = host.report && host.report->stamp.run_id != report.stamp.run_id;
  const bool was_silent = std::exchange(host.is_silent, false);
  const bool is_new = !host.report && report.host != own_;
  host.report = report;
  if (report.processes.size() > kProcessesMax) {
    host.report->processes.resize(kProcessesMax);
  }
  host.at = now;
  if (was_restarted) {
    return "host " + readable(report.host) + " was started again";
  }
  if (was_silent || is_new) {
    return "host " + readable(report.host) + (is_new ? " is up" : " is received again");
  }
  return std::nullopt;
}

std::vector<std::string> HostBoard::fallen_silent(Time now) {
  std::vector<std::string> out;
  for (auto& [name, host] : hosts_) {
    const double age_s = to_seconds(now - host.at);
    if (name != own_ && !host.is_silent && age_s > kSilentAfter_s) {
      host.is_silent = true;
      out.push_back(fmt::format("host {} {} for {:.0f} s", readable(name),
                                host.report ? "has been silent" : "has sent no report", age_s));
    }
  }
  return out;
}

std::vector<std::string> HostBoard::table(Time now) const {
  std::vector<std::string> out{fmt::format("{:<8} {:<14} {:>9} {:>9} {:>10} {:>8} {:>11}  {}",
                                           "host", "process", "state", "restarts", "down", "CPU",
                                           "memory", "last end")};
  for (const auto& [name, host] : hosts_) {
    if (!host.report || host.is_silent) {
      out.push_back(fmt::format("{:<8} {} for {:.0f} s", readable(name),
                                host.report ? "silent" : "no report", to_seconds(now - host.at)));
      continue;
    }
    for (const models::SupervisedProcess& process : host.report->processes) {
      out.push_back(row_of(name, process));
    }
  }
  return out;
}

std::string HostBoard::line(Time now) const {
  std::string out;
  bool is_all_well = true;
  for (const auto& [name, host] : hosts_) {
    out += out.empty() ? "" : ", ";
    if (!host.report || host.is_silent) {
      out += fmt::format("{} silent for {:.0f} s", readable(name), to_seconds(now - host.at));
      is_all_well = is_all_well && name == own_ && !host.report;
      continue;
    }
    const auto& all = host.report->processes;
    const auto running = std::count_if(all.begin(), all.end(), [](const auto& process) {
      return process.phase == SupervisedPhase::kRunning;
    });
    out += fmt::format("{} {}/{}", readable(name), running, all.size());
    is_all_well = is_all_well && running == std::ssize(all);
  }
  return hosts_.size() == 1 && is_all_well ? "" : out;
}

}  // namespace vantage::tools
