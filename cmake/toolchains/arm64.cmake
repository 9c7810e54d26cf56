# Cross compilation for 64-bit ARM on Debian or Ubuntu (preset arm64). Headers and libraries come
# from VANTAGE_ARM64_ROOT, a folder with the arm64 packages that `tools/setup --arm64` makes. Tests
# run under qemu's user mode.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

set(VANTAGE_ARM64_ROOT "${CMAKE_CURRENT_LIST_DIR}/../../build/arm64-root" CACHE PATH
  "Folder with the arm64 packages that vantage needs (tools/setup --arm64)")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES VANTAGE_ARM64_ROOT)
if(NOT EXISTS "${VANTAGE_ARM64_ROOT}/usr/lib/aarch64-linux-gnu")
  message(FATAL_ERROR "${VANTAGE_ARM64_ROOT} has no arm64 packages: run tools/setup --arm64")
endif()
get_filename_component(root "${VANTAGE_ARM64_ROOT}" ABSOLUTE)
set(CMAKE_SYSROOT "${root}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_DIR} "")
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${root}")
set(libraries "${root}/usr/lib/aarch64-linux-gnu")
set(ENV{PKG_CONFIG_LIBDIR} "${libraries}/pkgconfig:${root}/usr/share/pkgconfig")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L "${root}")
# Disabled, because the build would describe arm64's Python by the host's Python.
set(VANTAGE_PYTHON OFF CACHE BOOL "Build the Python module")
