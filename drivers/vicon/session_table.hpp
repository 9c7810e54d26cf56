#pragma once

#include <memory>
#include <optional>

#include "drivers/vicon/session.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/identify.hpp"

namespace vantage::drivers::vicon {

/// One protocol, with the function that opens its session. A new protocol needs a line in
/// session_table.cpp.
struct SessionRow {
  scenario::MocapProtocol protocol;
  wire::vicon::ServerType server_type;  ///< server that speaks the protocol
  std::unique_ptr<Session> (*open)(const scenario::MocapSpec&, FrameSink);
};

/// Returns the row of `protocol`.
/// @throws StartupError if this driver does not speak it
const SessionRow& session_row(scenario::MocapProtocol protocol);

/// Returns the protocol of a server; nullopt if this driver does not speak it.
std::optional<scenario::MocapProtocol> protocol_of(wire::vicon::ServerType server_type);

}  // namespace vantage::drivers::vicon
