// signed_messages FOLDER: writes one random message of each type as it is published with and
// without keys: FOLDER/TYPE.signed and FOLDER/TYPE.plain.

#include <cstdint>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "bus/auth/envelope.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/bus/convert/sample_messages.hpp"

// The test types of this header need the names above.
#include "bus/convert/convert.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file

void write(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

template <class Message>
void write_both(const std::string& folder, const std::string& channel, test::Sampler& sampler) {
  const auto wire = bus::to_wire(test::sample<Message>(sampler));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  const std::string stem = folder + "/" + wire.getTypeName();
  write(stem + ".plain", bytes);
  const bus::auth::Role role = bus::auth::role_of(channel);
  const bus::auth::Key key = test::key_of(role, 1);
  std::vector<bus::auth::Echo> echoes;
  if (role == bus::auth::Role::kOperator) {
    echoes = {{bus::auth::destination_of("Q1"), 1}, {bus::auth::destination_of("Q2"), 2}};
  }
  bus::auth::sign(key, channel, {key.id, 1, 1, role, scenario::TrialMode::kLive}, echoes, bytes);
  write(stem + ".signed", bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "signed_messages FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  test::Sampler sampler(20'261'123);
  write_both<models::MocapFrame>(folder, "VICON", sampler);
  write_both<models::OperatorCommand>(folder, "COMMAND", sampler);
  write_both<models::RobotPlan>(folder, "PLAN_Q1", sampler);
  write_both<models::PlanProposal>(folder, "PROPOSAL_Q1", sampler);
  write_both<models::TeamProposal>(folder, "TEAM_PROPOSAL_Q1", sampler);
  write_both<models::VehicleStatus>(folder, "VEHICLE_Q1", sampler);
  write_both<models::RobotMeasurement>(folder, "MEASUREMENT_Q1", sampler);
  write_both<models::RangeScan>(folder, "SCAN_Q1", sampler);
  write_both<models::RobotBelief>(folder, "BELIEF_Q1", sampler);
  write_both<models::BeliefMixture>(folder, "MIXTURE_Q1", sampler);
  write_both<models::RobotMap>(folder, "MAP_Q1", sampler);
  write_both<models::AttackNotice>(folder, "ATTACK", sampler);
  write_both<models::ScenarioNotice>(folder, "SCENARIO", sampler);
  write_both<models::TruthFrame>(folder, "TRUTH", sampler);
  write_both<models::CollisionReport>(folder, "COLLISION", sampler);
  write_both<models::ProcessHealth>(folder, "HEALTH_A", sampler);
  write_both<models::HostReport>(folder, "HOST_A", sampler);
  return 0;
}
