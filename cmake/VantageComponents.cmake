# Components of vantage that other projects may use separately, each with its libraries, the
# components that it needs, and the packages that it needs. The build reads this file; after the
# installation, find_package(vantage) reads it.
include_guard()

set(vantage_components core models wire scenario planner estimator localizer scenario_reader drivers bus logs)

# vantage_<component>_libraries: libraries of the component. If no library has the component's name,
# an interface library with that name links all of them. …_needs: components that it needs.
# …_packages: packages that it needs (vantage_find_package()). …_public: its public headers without
# the ending .hpp; only these and the headers that they include are installed.
set(vantage_core_libraries core)
set(vantage_core_needs)
set(vantage_core_packages Eigen3)
set(vantage_core_public
  core/angle core/check core/deadline core/pose core/result core/time)

set(vantage_models_libraries models mapping_models)
set(vantage_models_needs core)
set(vantage_models_packages)
set(vantage_models_public
  models/belief/gaussian models/belief/mixture models/exchange/compact_belief models/exchange/messages
  models/exchange/pose_messages
  models/mapping/beam
  models/mapping/mapping_spec models/mapping/occupancy_belief models/motion/unicycle
  models/motion/vehicle_limits models/plan/plan models/sensor/kind models/sensor/kinds/kinds
  models/sensor/law models/sensor/sensor models/target/kind models/target/law
  models/target/target_model models/world/grid models/world/world)

set(vantage_wire_libraries
  autopilot_parameters crtp_wire mavlink natnet_wire qualisys_wire rover_wire sitl_wire vicon_wire)
set(vantage_wire_needs models)
set(vantage_wire_packages fmt SODIUM)
set(vantage_wire_public
  wire/crtp/flight wire/crtp/link_uri wire/crtp/packet wire/crtp/system wire/crtp/tables
  wire/mavlink/frame wire/mavlink/messages wire/mavlink/parser wire/mavlink/signing
  wire/rover/packet wire/sitl/crazyflie_sensors wire/sitl/json_physics wire/vicon/datastream
  wire/vicon/object_stream wire/vicon/vrpn)

set(vantage_scenario_libraries scenario)
set(vantage_scenario_needs models)
set(vantage_scenario_packages)
set(vantage_scenario_public
  scenario/localizer_spec scenario/mocap_protocol scenario/scenario scenario/team_algorithm scenario/vehicle_kinds)

set(vantage_planner_libraries planner)
set(vantage_planner_needs scenario)
set(vantage_planner_packages)
set(vantage_planner_public
  planner/decision/catalogue planner/decision/decision planner/decision/team_oracle
  planner/mapping/map_planner planner/problem/owned_problem planner/problem/problem
  planner/robot/robot_planner planner/robot/searching_planner planner/search/arvi
  planner/search/astar planner/search/beam planner/search/catalogue planner/search/plan_path)

set(vantage_estimator_libraries estimator)
set(vantage_estimator_needs scenario)
set(vantage_estimator_packages)
set(vantage_estimator_public
  estimator/filter/central_filter estimator/filter/distributed_filter
  estimator/occupancy/occupancy estimator/occupancy/team_map)

set(vantage_localizer_libraries localizer)
set(vantage_localizer_needs scenario)
set(vantage_localizer_packages)
set(vantage_localizer_public
  localizer/commanded_motion localizer/robot_localizer localizer/sighting_model
  localizer/start_search localizer/team_filter)

set(vantage_scenario_reader_libraries scenario_reader)
set(vantage_scenario_reader_needs scenario)
set(vantage_scenario_reader_packages yaml-cpp fmt)
set(vantage_scenario_reader_public
  scenario/reader/localizer_yaml scenario/reader/overrides scenario/reader/scenario_yaml)

set(vantage_drivers_libraries
  crazyflie_driver natnet_driver qualisys_driver quadrotor_driver rover_driver safety sensor_driver
  vehicle_body vehicle_port vicon_driver)
set(vantage_drivers_needs scenario wire)
set(vantage_drivers_packages fmt LIBUSB)
set(vantage_drivers_public
  drivers/crazyflie/driver drivers/natnet/natnet_session drivers/qualisys/qtm_session
  drivers/quadrotor/driver drivers/rover/driver drivers/safety/guard drivers/safety/inputs
  drivers/safety/limits drivers/safety/setpoint drivers/sensor/pose_sensor
  drivers/sensor/range_scanner drivers/vehicle/port drivers/vicon/driver drivers/vicon/session
  drivers/vicon/session_table)

set(vantage_bus_libraries lcm bus)
set(vantage_bus_needs scenario)
set(vantage_bus_packages LCM Threads SODIUM fmt)
set(vantage_bus_public
  bus/convert/channels bus/convert/convert bus/node/bus bus/node/clock bus/node/node
  bus/transport/transport bus/transport/url)

set(vantage_logs_libraries
  appearance foxglove log_analysis log_export log_file log_play metrics mrclam record)
set(vantage_logs_needs bus scenario_reader)
set(vantage_logs_packages nlohmann_json fmt ZSTD)
set(vantage_logs_public
  logs/analysis/log_analysis logs/edit/edit logs/export/csv_export logs/export/mcap_export
  logs/file/log_event logs/file/log_index logs/file/log_scan logs/file/mapped_file
  logs/file/message_visit logs/file/seekable_log logs/metrics/ospa logs/metrics/trial_metrics
  logs/play/player logs/record/recorder)

# vantage_with_needs(<variable> <component>…): sets <variable> to the components and all components
# that these need, in the order of vantage_components.
function(vantage_with_needs variable)
  set(wanted ${ARGN})
  set(all)
  while(wanted)
    list(POP_FRONT wanted component)
    if(NOT component IN_LIST all)
      list(APPEND all ${component})
      list(APPEND wanted ${vantage_${component}_needs})
    endif()
  endwhile()
  set(ordered)
  foreach(component IN LISTS vantage_components)
    if(component IN_LIST all)
      list(APPEND ordered ${component})
    endif()
  endforeach()
  set(${variable} ${ordered} PARENT_SCOPE)
endfunction()

# vantage_find_package(<name>): sets <name>_FOUND and creates the package's targets for the libraries.
# vantage_debian_<name>: Debian packages for the error message if the package is missing.
set(vantage_debian_Eigen3 libeigen3-dev)
set(vantage_debian_yaml-cpp libyaml-cpp-dev)
set(vantage_debian_fmt libfmt-dev)
set(vantage_debian_SODIUM "libsodium-dev and pkg-config")
set(vantage_debian_LIBUSB "libusb-1.0-0-dev and pkg-config")
set(vantage_debian_ZSTD "libzstd-dev and pkg-config")
set(vantage_debian_LCM "liblcm-dev, libglib2.0-dev and pkg-config")
set(vantage_debian_Threads libc6-dev)
set(vantage_debian_nlohmann_json nlohmann-json3-dev)
macro(vantage_find_package name)
  if("${name}" STREQUAL "Eigen3")
    find_package(Eigen3 3.4 QUIET NO_MODULE)
  elseif("${name}" STREQUAL "yaml-cpp")
    find_package(yaml-cpp 0.7 QUIET)
  elseif("${name}" STREQUAL "fmt")
    find_package(fmt 9 QUIET)
  elseif("${name}" STREQUAL "nlohmann_json")
    find_package(nlohmann_json 3.11 QUIET)
  elseif("${name}" STREQUAL "Threads")
    find_package(Threads QUIET)
  else()
    find_package(PkgConfig QUIET)
    set(${name}_FOUND FALSE)
    if(TARGET PkgConfig::${name})
      set(${name}_FOUND TRUE)
    elseif(NOT PkgConfig_FOUND)
    elseif("${name}" STREQUAL "LCM")
      pkg_check_modules(LCM QUIET IMPORTED_TARGET lcm>=1.3.1)
    elseif("${name}" STREQUAL "SODIUM")
      pkg_check_modules(SODIUM QUIET IMPORTED_TARGET libsodium)
    elseif("${name}" STREQUAL "ZSTD")
      pkg_check_modules(ZSTD QUIET IMPORTED_TARGET libzstd)
    elseif("${name}" STREQUAL "LIBUSB")
      pkg_check_modules(LIBUSB QUIET IMPORTED_TARGET libusb-1.0)
    endif()
  endif()
endmacro()
