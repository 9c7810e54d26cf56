# Debian packages of the installed files (tools/dev/package): one package for each part of
# VantageInstall, and python3-vantage if python/ installs a part of that name.
set(CPACK_GENERATOR DEB)
set(VANTAGE_MAINTAINER "vantage developers <vantage@localhost>" CACHE STRING
  "Maintainer that the packages name")
set(CPACK_PACKAGE_CONTACT ${VANTAGE_MAINTAINER})
set(CPACK_PACKAGE_VENDOR "the vantage developers")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
if(CMAKE_CROSSCOMPILING AND is_arm64)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CPACK_PACKAGE_CONTACT})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

get_cmake_property(CPACK_COMPONENTS_ALL COMPONENTS)
list(REMOVE_ITEM CPACK_COMPONENTS_ALL Unspecified)

# vantage_package(<part> NAME … SECTION … [ARCHITECTURE all] [DEPENDS …] SUMMARY … TEXT …)
macro(vantage_package part)
  cmake_parse_arguments(PACKAGE "" "NAME;SECTION;ARCHITECTURE;DEPENDS;RECOMMENDS;SUMMARY;TEXT" "" ${ARGN})
  string(TOUPPER ${part} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${PACKAGE_NAME})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${PACKAGE_SECTION})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${PACKAGE_DEPENDS}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${PACKAGE_RECOMMENDS}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${PACKAGE_SUMMARY}\n${PACKAGE_TEXT}")
  if(PACKAGE_ARCHITECTURE)
    set(CPACK_DEBIAN_${upper}_PACKAGE_ARCHITECTURE ${PACKAGE_ARCHITECTURE})
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS OFF)
  else()
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
  endif()
  # Files that Debian requires in every package.
  set(papers ${PROJECT_BINARY_DIR}/packaging/${PACKAGE_NAME})
  file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
  file(READ ${PROJECT_SOURCE_DIR}/packaging/copyright copyright)
  file(CONFIGURE OUTPUT ${papers}/copyright CONTENT "${license}\n${copyright}" @ONLY)
  install(FILES ${papers}/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${PACKAGE_NAME} COMPONENT ${part})
  # tools/dev/package writes the changelog.
  install(FILES ${PROJECT_BINARY_DIR}/packaging/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${PACKAGE_NAME} COMPONENT ${part} OPTIONAL)
endmacro()

vantage_package(runtime NAME vantage SECTION science
  DEPENDS "adduser, liblcm-bin" RECOMMENDS "gnuplot-nox, librsvg2-bin, xz-utils"
  SUMMARY "LCM lab stack for active information acquisition"
  TEXT "Teams of robots that gather information: one planner and one estimator
per robot, drivers for motion capture and vehicles, a simulator, a
viewer in the browser, and the commands that check, fly, record and
judge trials.")
vantage_package(dev NAME libvantage-dev SECTION libdevel
  DEPENDS "libeigen3-dev"
  RECOMMENDS "vantage-lcmtypes (= ${PROJECT_VERSION}), cmake, pkg-config, libfmt-dev, liblcm-dev, libglib2.0-dev, libsodium-dev, libyaml-cpp-dev, nlohmann-json3-dev"
  SUMMARY "development files of vantage: planners, filters, drivers and logs"
  TEXT "Static libraries and headers for find_package(vantage). Components planner
and estimator need only Eigen, the others the recommended packages.")
vantage_package(lcmtypes NAME vantage-lcmtypes SECTION devel ARCHITECTURE all DEPENDS "python3:any"
  RECOMMENDS "liblcm-bin"
  SUMMARY "messages of vantage for LCM"
  TEXT "The .lcm files and the code that lcm-gen generates for C, C++, Python and Java
(a jar for lcm-spy).")
vantage_package(doc NAME vantage-doc SECTION doc ARCHITECTURE all
  SUMMARY "documentation of vantage"
  TEXT "How to set up a lab, fly, record, extend; decisions and measured results;
examples and a sample log.")
if("python" IN_LIST CPACK_COMPONENTS_ALL)
  vantage_package(python NAME python3-vantage SECTION python DEPENDS "python3, python3-numpy"
    SUMMARY "vantage in Python"
    TEXT "Problems, plans, filters, trials and logs of vantage as Python values.")
endif()
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA
  ${PROJECT_SOURCE_DIR}/packaging/postinst)
foreach(part LCMTYPES PYTHON)
  set(CPACK_DEBIAN_${part}_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/packaging/python/postinst ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
endforeach()
include(CPack)
