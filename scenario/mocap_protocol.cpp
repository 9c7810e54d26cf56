#include "scenario/mocap_protocol.hpp"

#include <array>

namespace vantage::scenario {
namespace {

constexpr MocapProtocolRow kMocapRows[] = {
    {"datastream", 801, false, "vicon"},
    {"object_stream", 51001, true, "vicon"},
    {"vrpn", 3883, false, "vicon"},
};

}  // namespace

constinit const MocapProtocol MocapProtocol::kDataStream(kMocapRows[0]);
constinit const MocapProtocol MocapProtocol::kObjectStream(kMocapRows[1]);
constinit const MocapProtocol MocapProtocol::kVrpn(kMocapRows[2]);

std::span<const MocapProtocol> all_mocap_protocols() {
  static constexpr std::array kAll{MocapProtocol(kMocapRows[0]), MocapProtocol(kMocapRows[1]),
                                   MocapProtocol(kMocapRows[2])};
  return kAll;
}

}  // namespace vantage::scenario
