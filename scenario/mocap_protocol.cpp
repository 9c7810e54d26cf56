#include "scenario/mocap_protocol.hpp"

#include <array>

namespace vantage::scenario {
namespace {

constexpr MocapProtocolRow kRows[] = {
    {"datastream", 801, false, "vicon"},
    {"object_stream", 51001, true, "vicon"},
    {"vrpn", 3883, false, "vicon"},
};

}  // namespace

constinit const MocapProtocol MocapProtocol::kDataStream(kRows[0]);
constinit const MocapProtocol MocapProtocol::kObjectStream(kRows[1]);
constinit const MocapProtocol MocapProtocol::kVrpn(kRows[2]);

std::span<const MocapProtocol> all_mocap_protocols() {
  static constexpr std::array kAll{MocapProtocol(kRows[0]), MocapProtocol(kRows[1]),
                                   MocapProtocol(kRows[2])};
  return kAll;
}

}  // namespace vantage::scenario
