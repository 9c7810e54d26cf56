#include "bus/node/command_claim.hpp"

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"

namespace vantage::bus {

std::optional<auth::Authenticator::CommandClaim> claim_of(std::string_view channel,
                                                          std::span<const std::uint8_t> bytes,
                                                          std::string_view own) {
  if (channel != kCommand.name) {
    return std::nullopt;
  }
  const auto wire = decode_wire<vantage_lcm::command_t>(bytes);
  const auto command = wire ? from_wire(*wire) : std::nullopt;
  if (!command) {
    return std::nullopt;
  }
  return auth::Authenticator::CommandClaim{
      command->stamp.time, models::makes_safer(command->action),
      command->action == models::OperatorAction::kEmergencyStop,
      !command->robot.empty() && command->robot != own};
}

}  // namespace vantage::bus
