#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "wire/natnet/packet.hpp"

namespace vantage::wire::natnet {

/// Rigid body that a server can report.
struct BodyDefinition {
  std::int32_t id = 0;
  std::string name;
};

/// Content of a definitions packet. Marker sets, skeletons, plates, devices and cameras are
/// skipped.
struct Definitions {
  std::vector<BodyDefinition> bodies;
  /// False if the packet ended early or has a type whose size is unknown; `bodies` then contains
  /// the bodies before that point.
  bool is_complete = true;
};

/// Reads the payload of a definitions packet in the layout of `version`.
void decode_definitions(Bytes payload, const Version& version, Definitions& out);

/// Appends a definitions packet with a marker set and a rigid body per definition. Returns false if
/// the packet would be too large.
bool append_definitions(std::vector<std::uint8_t>& out, const Version& version,
                        const std::vector<BodyDefinition>& bodies);

}  // namespace vantage::wire::natnet
