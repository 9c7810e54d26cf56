# Runs the harnesses on their initial inputs and on inputs that once broke them, in every build, without libFuzzer.
vantage_test(fuzz
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/fuzz_test.cpp ${CMAKE_CURRENT_LIST_DIR}/bus/packet_path.cpp
    ${CMAKE_CURRENT_LIST_DIR}/bus/compact_path.cpp ${CMAKE_CURRENT_LIST_DIR}/bus/receive_path.cpp ${CMAKE_CURRENT_LIST_DIR}/parsers/mocap_parsers.cpp
    ${CMAKE_CURRENT_LIST_DIR}/parsers/stream_parsers.cpp
    ${CMAKE_CURRENT_LIST_DIR}/parsers/text_parsers.cpp ${CMAKE_CURRENT_LIST_DIR}/vicon/harness.cpp
  DEPS
    vantage::bus vantage::log_file vantage::crtp_wire vantage::mavlink vantage::natnet_driver
    vantage::plan vantage::qualisys_driver vantage::safety vantage::scenario_reader
    vantage::vicon_driver vantage::vicon_emulator vantage::view PkgConfig::LCM)
