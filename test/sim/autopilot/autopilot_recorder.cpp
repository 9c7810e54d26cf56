// Records what real firmware does in a drill:
//   autopilot_recorder DRILL BINARY FOLDER > DRILL.csv
// BINARY is built as in docs/guide/firmware.md. It is started as by `vantage up` and works in
// FOLDER, with the ports of instance 0. Without arguments, the program lists the drills. With DRILL
// alone, the emulated autopilot plays it. Not part of ctest; recordings_test.cpp compares the
// recordings.

#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "core/process.hpp"
#include "test/sim/autopilot/drill.hpp"
#include "test/sim/autopilot/firmware_station.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): main file only

int record(int count, char** words) {
  if (count < 2) {
    for (const test::DrillCase& drill : test::drill_cases()) {
      std::cout << drill.name << '\n';
    }
    return 0;
  }
  const test::DrillCase& drill = test::drill_case(words[1]);
  const bool is_real = count >= 4;
  std::unique_ptr<test::ScriptedStation> station;
  if (is_real) {
    station = std::make_unique<test::FirmwareStation>(drill.dialect, words[2], words[3], 1);
  } else {
    station = std::make_unique<test::EmulatorStation>(drill.dialect, Pose3{}, 0.1);
  }
  test::Recording recording = test::play(drill, *station);
  const bool is_px4 = drill.dialect == models::AutopilotDialect::kPx4;
  recording.provenance = {
      is_real ? (is_px4 ? "PX4 1.18.0 (6a1c532983), simulator_mavlink in lockstep at 250 Hz"
                        : "ArduCopter 4.6.2 (1ebd4d996e), JSON physics in lockstep at 800 Hz")
              : "emulated",
      "autopilot_recorder " + drill.name + (is_px4 ? " px4 FOLDER" : " arducopter FOLDER"),
      std::string("parameters: config/autopilot/") + (is_px4 ? "px4.params" : "ardupilot.parm") +
          ", the airframe's of `vantage up`"};
  for (const auto& [name, value] : drill.parameters) {
    recording.provenance.back() += fmt::format(", {} {:g}", name, value);
  }
  std::cout << recording;
  return 0;
}

}  // namespace

int main(int count, char** words) {
  return run_process("autopilot_recorder", [&] { return record(count, words); });
}
