#include "trial/simulated_network.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::trial {
namespace {

constexpr double kQueueS = 0.1;
constexpr double kFrameBytes = 1500.0;
constexpr double kBytesPerKbit = 125.0;
constexpr double kQueueBytesMin = 8 * kFrameBytes;

/// Returns a number in [0, 1) that depends on all bits of the arguments (SplitMix64's finaliser).
double uniform_of(std::uint64_t seed, std::uint64_t message, std::string_view host) {
  std::uint64_t hash = seed ^ (message * 0x9e3779b97f4a7c15ULL);
  for (const char c : host) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebULL;
  hash ^= hash >> 31U;
  return static_cast<double>(hash >> 11U) * 0x1p-53;
}

}  // namespace

SimulatedNetwork::SimulatedNetwork(const scenario::Scenario& scenario, const bus::Clock& clock)
    : spec_(scenario.network.simulation),
      seed_(scenario.seed),
      clock_(clock),
      channels_(scenario) {}

void SimulatedNetwork::send(std::string_view channel, std::size_t bytes, bus::Reach reach) {
  sender_ = channels_.robot_of(channel);
  ++messages_;
  is_on_air_ = reach == bus::Reach::kAll;
  if (sender_.empty() || !is_on_air_) {
    return;
  }
  const auto air_bytes = static_cast<double>(bus::bytes_on_air(channel.size(), bytes));
  if (spec_.rate_kbitps > 0.0) {
    const Time now = clock_.now();
    const double rate_Bps = spec_.rate_kbitps * kBytesPerKbit;
    Time& free_at = free_at_.try_emplace(sender_, now).first->second;
    free_at = std::max(free_at, now);
    const double waiting = to_seconds(free_at - now) * rate_Bps;
    const double room = std::max(kQueueS * rate_Bps, kQueueBytesMin) - waiting;
    is_on_air_ = air_bytes <= room;
    // If a message does not fit, its frames that fit are sent nevertheless.
    const double sent =
        is_on_air_ ? air_bytes : std::max(0.0, std::floor(room / kFrameBytes) * kFrameBytes);
    free_at += from_seconds(sent / rate_Bps);
    if (!is_on_air_) {
      return;
    }
  }
  const std::string_view kind = channel.starts_with("HEALTH_")
                                    ? std::string_view("HEALTH")
                                    : channel.substr(0, channel.size() - sender_.size() - 1);
  bytes_sent_.try_emplace(std::string(kind)).first->second += static_cast<std::int64_t>(air_bytes);
  survival_ = std::pow(1.0 - spec_.loss, std::ceil(air_bytes / kFrameBytes));
}

std::vector<models::NamedCount> SimulatedNetwork::bytes_sent() const {
  std::vector<models::NamedCount> out;
  for (const auto& [kind, bytes] : bytes_sent_) {
    out.push_back({kind, bytes});
  }
  return out;
}

bool SimulatedNetwork::arrives_at(const std::string& host) {
  if (sender_.empty() || sender_ == host) {
    return true;
  }
  return is_on_air_ && uniform_of(seed_, messages_, host) < survival_;
}

}  // namespace vantage::trial
