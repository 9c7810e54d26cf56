# Rules of `cmake --install`, by part: runtime (commands, scenarios, page), dev (libraries, headers,
# find_package), lcmtypes (messages for other languages), doc. tools/dev/package makes a Debian package
# of each part.
include_guard()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(data ${CMAKE_INSTALL_DATADIR}/vantage)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/vantage)

# --- dev: components that other projects link ---
set(installed_headers)
foreach(component IN LISTS built_components)
  set(libraries)
  foreach(name IN LISTS vantage_${component}_libraries)
    list(APPEND libraries vantage_${name})
  endforeach()
  if(NOT TARGET vantage_${component})
    add_library(vantage_${component} INTERFACE)
    target_link_libraries(vantage_${component} INTERFACE ${libraries})
    add_library(vantage::${component} ALIAS vantage_${component})
    list(APPEND libraries vantage_${component})
  endif()
  foreach(library IN LISTS libraries)
    string(REGEX REPLACE "^vantage_" "" name ${library})
    set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
    get_target_property(headers ${library} VANTAGE_HEADERS)
    if(headers)
      list(APPEND installed_headers ${headers})
    endif()
    install(TARGETS ${library} EXPORT vantage_${component}
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
    get_target_property(type ${library} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
      list(JOIN vantage_seal_command "\" \"" seal)
      set(archive "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/lib${library}.a")
      install(CODE "
        execute_process(
          COMMAND \"${seal}\" -D \"ARCHIVE=${archive}\"
            -P \"${PROJECT_SOURCE_DIR}/cmake/SealArchive.cmake\"
          COMMAND_ERROR_IS_FATAL ANY)" COMPONENT dev)
    endif()
  endforeach()
  install(EXPORT vantage_${component} NAMESPACE vantage:: FILE vantage-${component}.cmake
    DESTINATION ${cmake_folder} COMPONENT dev)
endforeach()

# --- dev: public headers and the headers that they include, with the include paths of other projects ---
list(REMOVE_DUPLICATES installed_headers)
set(all_headers)
foreach(header IN LISTS installed_headers)
  file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${header})
  list(APPEND all_headers ${relative})
endforeach()
set(public_headers)
foreach(component IN LISTS built_components)
  list(TRANSFORM vantage_${component}_public APPEND .hpp OUTPUT_VARIABLE headers)
  list(APPEND public_headers ${headers})
endforeach()
set(relative_headers)
set(installed_headers)
set(waiting ${public_headers})
while(waiting)
  list(POP_FRONT waiting header)
  if(header IN_LIST relative_headers)
    continue()
  endif()
  if(NOT header IN_LIST all_headers)
    message(FATAL_ERROR "public header ${header}: no installed library has it; correct "
      "vantage_<component>_public in cmake/VantageComponents.cmake")
  endif()
  list(APPEND relative_headers ${header})
  list(APPEND installed_headers ${PROJECT_SOURCE_DIR}/${header})
  file(STRINGS ${header} includes REGEX "^#include \"")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" included "${line}")
    if(included IN_LIST all_headers)
      list(APPEND waiting ${included})
    endif()
  endforeach()
endwhile()
list(JOIN relative_headers "\n" lines)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers.txt CONTENT "${lines}\n" @ONLY)
list(JOIN public_headers "\n" lines)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/public_headers.txt CONTENT "${lines}\n" @ONLY)
add_custom_command(
  OUTPUT ${PROJECT_BINARY_DIR}/headers.stamp
  COMMAND ${CMAKE_COMMAND} -D SOURCE=${PROJECT_SOURCE_DIR} -D OUTPUT=${PROJECT_BINARY_DIR}/include
    -D LIST=${PROJECT_BINARY_DIR}/headers.txt -D PUBLIC=${PROJECT_BINARY_DIR}/public_headers.txt
    -P ${PROJECT_SOURCE_DIR}/cmake/WriteHeaders.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${PROJECT_BINARY_DIR}/headers.stamp
  DEPENDS ${installed_headers} ${PROJECT_BINARY_DIR}/headers.txt
    ${PROJECT_BINARY_DIR}/public_headers.txt
    ${PROJECT_SOURCE_DIR}/cmake/WriteHeaders.cmake
  COMMENT "headers for installation"
  VERBATIM)
add_custom_target(vantage_headers ALL DEPENDS ${PROJECT_BINARY_DIR}/headers.stamp)
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/vantage
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)

# Before version 1.0, any minor version may break user code.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vantageConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(
  FILES ${PROJECT_BINARY_DIR}/vantageConfigVersion.cmake cmake/vantageConfig.cmake
    cmake/VantageComponents.cmake
  DESTINATION ${cmake_folder} COMPONENT dev)

# --- lcmtypes: message types for other languages ---
if(TARGET vantage_lcm)
  get_target_property(lcm_sources vantage_lcm VANTAGE_LCM_SOURCES)
  set(languages ${PROJECT_BINARY_DIR}/lcmtypes_languages)
  find_file(LCM_JAR lcm.jar PATHS /usr/share/java)
  find_program(JAVAC javac)
  find_program(JAR jar)
  set(make_jar)
  if(LCM_JAR AND JAVAC AND JAR)
    set(make_jar
      COMMAND ${LCM_GEN} -j --jpath ${languages}/java ${lcm_sources}
      COMMAND sh -c "find ${languages}/java -name '*.java' | xargs ${JAVAC} -nowarn -Xlint:none --release 8 -cp ${LCM_JAR} -d ${languages}/classes"
      COMMAND ${JAR} --create --file ${languages}/vantage-lcm.jar -C ${languages}/classes .)
    install(FILES ${languages}/vantage-lcm.jar
      DESTINATION ${CMAKE_INSTALL_DATADIR}/vantage/lcmtypes COMPONENT lcmtypes OPTIONAL)
  endif()
  add_custom_command(
    OUTPUT ${languages}/stamp
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${languages}
    COMMAND ${CMAKE_COMMAND} -E make_directory
      ${languages}/c ${languages}/python ${languages}/java ${languages}/classes
    COMMAND ${LCM_GEN} -c --c-cpath ${languages}/c --c-hpath ${languages}/c ${lcm_sources}
    COMMAND ${LCM_GEN} -p --ppath ${languages}/python ${lcm_sources}
    ${make_jar}
    COMMAND ${CMAKE_COMMAND} -E touch ${languages}/stamp
    DEPENDS ${lcm_sources}
    COMMENT "generating messages for C, Python and Java"
    VERBATIM)
  add_custom_target(vantage_lcmtypes DEPENDS ${languages}/stamp)
  get_target_property(lcm_includes vantage_lcm VANTAGE_LCM_HEADERS)
  install(DIRECTORY ${lcm_includes}/vantage_lcm
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT lcmtypes OPTIONAL FILES_MATCHING PATTERN "*.hpp")
  install(FILES ${lcm_sources} DESTINATION ${data}/lcmtypes COMPONENT lcmtypes)
  install(DIRECTORY ${languages}/c DESTINATION ${data}/lcmtypes COMPONENT lcmtypes OPTIONAL)
  install(DIRECTORY ${languages}/python/vantage_lcm
    DESTINATION lib/python3/dist-packages COMPONENT lcmtypes OPTIONAL)
endif()

# --- runtime: commands, scenarios, the viewer's page, systemd's unit ---
if(VANTAGE_EVERYTHING)
  # tools/dev/package writes the manual pages from --help.
  install(DIRECTORY ${PROJECT_BINARY_DIR}/packaging/man1
    DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime OPTIONAL)
  install(TARGETS
    vantage vantage-camera vantage-camera-emulator vantage-contacts vantage-crazyflie
    vantage-estimator vantage-localizer vantage-natnet vantage-planner
    vantage-qualisys vantage-quadrotor vantage-rover
    vantage-sensor vantage-sim vantage-vicon vantage-vicon-emulator
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  install(DIRECTORY config DESTINATION ${data} COMPONENT runtime)
  # Software bill of materials of the programs, if python3 and dpkg are available.
  find_program(PYTHON3_PROGRAM python3)
  find_program(DPKG_QUERY dpkg-query)
  set(foreign_root)
  if(CMAKE_CROSSCOMPILING)
    set(foreign_root "--root \"${CMAKE_SYSROOT}\"")
  endif()
  if(PYTHON3_PROGRAM AND DPKG_QUERY)
    install(CODE "
      file(GLOB programs \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/vantage*\")
      execute_process(
        COMMAND \"${PYTHON3_PROGRAM}\" \"${PROJECT_SOURCE_DIR}/tools/dev/sbom\" --version ${PROJECT_VERSION} --made ${foreign_root}
          --sources libeigen3-dev nlohmann-json3-dev libcli11-dev musl-dev
          --npm \"${PROJECT_SOURCE_DIR}/tools/view/page/package.json\" --programs \${programs}
        OUTPUT_FILE \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${data}/sbom.cdx.json\"
        COMMAND_ERROR_IS_FATAL ANY)" COMPONENT runtime)
  endif()
  install(DIRECTORY ${PROJECT_BINARY_DIR}/page DESTINATION ${data} COMPONENT runtime OPTIONAL)
  # The systemd unit contains the installed paths of the programs, which are known only at install
  # time.
  set(pages ${CMAKE_INSTALL_DATADIR}/doc/vantage)
  foreach(part runtime doc)
    install(CODE "
      file(READ \"${PROJECT_SOURCE_DIR}/docs/systemd/vantage.service\" unit)
      string(REPLACE /usr/local/bin \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\" unit \"\${unit}\")
      file(WRITE \"${PROJECT_BINARY_DIR}/vantage.service\" \"\${unit}\")" COMPONENT ${part})
  endforeach()
  install(FILES ${PROJECT_BINARY_DIR}/vantage.service
    DESTINATION lib/systemd/system COMPONENT runtime)
  install(FILES ${PROJECT_BINARY_DIR}/vantage.service
    DESTINATION ${pages}/docs/systemd COMPONENT doc)

  install(FILES packaging/completion.bash
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME vantage
    COMPONENT runtime)

  # The pages are copied with their folder structure and the files that they link to, so that links
  # stay valid (test docs.links).
  install(DIRECTORY docs examples DESTINATION ${pages} COMPONENT doc
    PATTERN systemd EXCLUDE PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/site/ DESTINATION ${pages}/html COMPONENT doc OPTIONAL)
  install(FILES logs/sample/lab_60s.lcmlog.xz DESTINATION ${pages}/examples COMPONENT doc)
  install(FILES CHANGELOG.md DESTINATION ${pages} COMPONENT doc)
  install(FILES lcmtypes/README.md DESTINATION ${pages}/lcmtypes COMPONENT doc)
  install(FILES tools/ros2/messages.idl DESTINATION ${pages}/tools/ros2 COMPONENT doc)
  install(FILES experiments/decisions/energy_trial.cpp DESTINATION ${pages}/experiments/decisions COMPONENT doc)
  install(DIRECTORY config/autopilot DESTINATION ${pages}/config COMPONENT doc)
  include(VantagePackages)
endif()
