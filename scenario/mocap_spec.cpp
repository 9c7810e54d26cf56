#include "scenario/mocap_spec.hpp"

namespace vantage::scenario {

const char* name_of(MocapProtocol protocol) {
  switch (protocol) {
    case MocapProtocol::kDataStream:
      return "datastream";
    case MocapProtocol::kObjectStream:
      return "object_stream";
    case MocapProtocol::kVrpn:
      return "vrpn";
  }
  return "unknown";
}

int default_port(MocapProtocol protocol) {
  switch (protocol) {
    case MocapProtocol::kDataStream:
      return 801;
    case MocapProtocol::kObjectStream:
      return 51001;
    case MocapProtocol::kVrpn:
      return 3883;
  }
  return 0;
}

}  // namespace vantage::scenario
