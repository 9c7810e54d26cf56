#include "drivers/vicon/session_table.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/check.hpp"
#include "drivers/vicon/datastream_session.hpp"
#include "drivers/vicon/object_stream_session.hpp"
#include "drivers/vicon/vrpn_session.hpp"

namespace vantage::drivers::vicon {
namespace {

using scenario::MocapProtocol;
using scenario::MocapSpec;
using wire::vicon::ServerType;

std::unique_ptr<Session> open_datastream(const MocapSpec& spec, FrameSink sink) {
  return std::make_unique<DataStreamSession>(spec.mode, spec.up_axis, std::move(sink));
}

std::unique_ptr<Session> open_object_stream(const MocapSpec& spec, FrameSink sink) {
  return std::make_unique<ObjectStreamSession>(spec.is_y_up(), std::move(sink));
}

std::unique_ptr<Session> open_vrpn(const MocapSpec& spec, FrameSink sink) {
  return std::make_unique<VrpnSession>(spec.is_y_up(), std::move(sink));
}

const std::array<SessionRow, 3>& rows() {
  static const std::array<SessionRow, 3> kRows{{
      {MocapProtocol::kDataStream, ServerType::kDataStream, open_datastream},
      {MocapProtocol::kObjectStream, ServerType::kObjectStream, open_object_stream},
      {MocapProtocol::kVrpn, ServerType::kVrpn, open_vrpn},
  }};
  return kRows;
}

}  // namespace

const SessionRow& session_row(MocapProtocol protocol) {
  const auto found = std::ranges::find(rows(), protocol, &SessionRow::protocol);
  if (found == rows().end()) {
    throw StartupError(std::string("mocap.protocol: vantage-vicon does not speak ") +
                       protocol.name() + "; its driver is vantage-" + protocol.driver());
  }
  return *found;
}

std::optional<MocapProtocol> protocol_of(ServerType server_type) {
  const auto found = std::ranges::find(rows(), server_type, &SessionRow::server_type);
  return found == rows().end() ? std::nullopt : std::optional(found->protocol);
}

}  // namespace vantage::drivers::vicon
