#include "scenario/mocap_protocol.hpp"

#include <array>

namespace vantage::scenario {
namespace {

constexpr MocapProtocolRow kMocapRows[] = {
    {"datastream", 801, MocapTransport::kTcp, false, "vicon"},
    {"object_stream", 51001, MocapTransport::kUdpReceived, false, "vicon"},
    {"vrpn", 3883, MocapTransport::kTcp, false, "vicon"},
    {"natnet", 1510, MocapTransport::kUdpRequested, true, "natnet"},
    {"qtm", 22223, MocapTransport::kTcp, false, "qualisys"},
};

}  // namespace

constinit const MocapProtocol MocapProtocol::kDataStream(kMocapRows[0]);
constinit const MocapProtocol MocapProtocol::kObjectStream(kMocapRows[1]);
constinit const MocapProtocol MocapProtocol::kVrpn(kMocapRows[2]);
constinit const MocapProtocol MocapProtocol::kNatNet(kMocapRows[3]);
constinit const MocapProtocol MocapProtocol::kQtm(kMocapRows[4]);

std::span<const MocapProtocol> all_mocap_protocols() {
  static constexpr std::array kAll{MocapProtocol(kMocapRows[0]), MocapProtocol(kMocapRows[1]),
                                   MocapProtocol(kMocapRows[2]), MocapProtocol(kMocapRows[3]),
                                   MocapProtocol(kMocapRows[4])};
  return kAll;
}

}  // namespace vantage::scenario
