#include "logs/file/wire_check.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "bus/auth/trailer.hpp"
#include "bus/convert/convert.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kFingerprintBytes = 8;

using Entry = std::pair<std::uint64_t, const bus::WireSchema*>;

template <class... Wire>
std::array<Entry, sizeof...(Wire)> table_of() {
  return {Entry{static_cast<std::uint64_t>(Wire::getHash()),
                bus::find_wire_schema(Wire::getTypeName())}...};
}

const auto& types() {
  static const auto kTypes =
      table_of<vantage_lcm::attack_t, vantage_lcm::belief_t, vantage_lcm::collision_t,
               vantage_lcm::command_t, vantage_lcm::compact_belief_t, vantage_lcm::health_t,
               vantage_lcm::host_t, vantage_lcm::map_t, vantage_lcm::measurement_t,
               vantage_lcm::mixture_t, vantage_lcm::odometry_t, vantage_lcm::sightings_t,
               vantage_lcm::pose_estimate_t, vantage_lcm::plan_t, vantage_lcm::proposal_t,
               vantage_lcm::vehicle_t, vantage_lcm::scan_t, vantage_lcm::scenario_t,
               vantage_lcm::team_proposal_t, vantage_lcm::truth_t, vantage_lcm::mocap_frame_t>();
  return kTypes;
}

}  // namespace

const bus::WireSchema* type_of(std::span<const std::uint8_t> data) {
  if (data.size() < kFingerprintBytes) {
    return nullptr;
  }
  const std::uint64_t fingerprint = read_big_endian(data.data(), kFingerprintBytes);
  const auto found = std::find_if(types().begin(), types().end(),
                                  [&](const Entry& entry) { return entry.first == fingerprint; });
  return found == types().end() ? nullptr : found->second;
}

DataCheck check_wire_data(const LogEvent& event) {
  const bus::WireSchema* schema = type_of(event.data);
  if (schema == nullptr) {
    return DataCheck::kNone;
  }
  const auto payload = bus::auth::payload_of(event.data);
  const bool is_whole = payload.size() >= kFingerprintBytes &&
                        bus::is_well_formed(*schema, payload.subspan(kFingerprintBytes));
  return is_whole ? DataCheck::kComplete : DataCheck::kDamaged;
}

}  // namespace vantage::logs
