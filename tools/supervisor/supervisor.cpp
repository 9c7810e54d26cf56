#include "tools/supervisor/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "core/check.hpp"

namespace vantage::tools {

void Supervisor::start(const ProcessSpec& spec) {
  Result<Child> child = Child::start(spec.arguments);
  if (!child.ok()) {
    throw StartupError("cannot start " + spec.name + ": " + child.error().message);
  }
  Supervised process;
  process.spec = spec;
  process.status.name = spec.name;
  process.child.emplace(std::move(child).value());
  processes_.push_back(std::move(process));
}

std::string Supervisor::on_end(Supervised& process, const std::string& how,
                               Nanoseconds now_ns) const {
  process.child.reset();
  process.status.last_end = how;
  if (process.status.restarts >= policy_.restarts_max) {
    process.status.phase = ProcessPhase::kGivenUp;
    return process.spec.name + " ended (" + how + "); given up after " +
           std::to_string(process.status.restarts) + " restarts";
  }
  const double backoff_s =
      std::min(policy_.backoff_first_s * std::exp2(process.status.restarts), policy_.backoff_max_s);
  process.restart_at_ns = now_ns + static_cast<Nanoseconds>(backoff_s * 1e9);
  process.status.phase = ProcessPhase::kWaiting;
  return process.spec.name + " ended (" + how + "); starting it again soon";
}

std::vector<std::string> Supervisor::poll(Nanoseconds monotonic_ns) {
  std::vector<std::string> events;
  for (Supervised& process : processes_) {
    if (process.child) {
      if (const auto ended = process.child->wait(std::chrono::milliseconds(0))) {
        events.push_back(on_end(process, ended->describe(), monotonic_ns));
      }
    } else if (process.status.phase == ProcessPhase::kWaiting &&
               monotonic_ns >= process.restart_at_ns) {
      ++process.status.restarts;
      Result<Child> child = Child::start(process.spec.arguments);
      if (child.ok()) {
        process.child.emplace(std::move(child).value());
        process.status.phase = ProcessPhase::kRunning;
        events.push_back(process.spec.name + " started again");
      } else {
        events.push_back(on_end(process, child.error().message, monotonic_ns));
      }
    }
  }
  return events;
}

std::vector<std::string> Supervisor::stop_all(std::chrono::milliseconds patience) {
  std::vector<std::string> killed;
  for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
    if (process->child) {
      process->child->send(SIGTERM);
    }
  }
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
    if (!process->child) {
      continue;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    const auto ended = process->child->wait(std::max(left, std::chrono::milliseconds(0)));
    if (!ended) {
      killed.push_back(process->spec.name);
    }
    process->status.last_end = ended ? ended->describe() : "killed";
    process->child.reset();  // kills and reaps what is left
  }
  processes_.clear();
  return killed;
}

std::vector<SupervisedStatus> Supervisor::status() const {
  std::vector<SupervisedStatus> out;
  for (const Supervised& process : processes_) {
    out.push_back(process.status);
  }
  return out;
}

int Supervisor::restarts() const {
  int total = 0;
  for (const Supervised& process : processes_) {
    total += process.status.restarts;
  }
  return total;
}

bool Supervisor::any_given_up() const {
  return std::any_of(processes_.begin(), processes_.end(), [](const Supervised& process) {
    return process.status.phase == ProcessPhase::kGivenUp;
  });
}

Child* Supervisor::find(const std::string& name) {
  for (Supervised& process : processes_) {
    if (process.spec.name == name && process.child) {
      return &*process.child;
    }
  }
  return nullptr;
}

}  // namespace vantage::tools
