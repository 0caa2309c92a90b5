# SPDX-License-Identifier: Apache-2.0
# find_package(aureole_optics): the target aureole::optics. The three libraries that it links come by pkg-config, as in the build of aureole.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(PkgConfig)
pkg_check_modules(CLIPPER QUIET REQUIRED IMPORTED_TARGET polyclipping)
pkg_check_modules(KISSFFT QUIET REQUIRED IMPORTED_TARGET kissfft-float)
pkg_check_modules(CERF QUIET REQUIRED IMPORTED_TARGET libcerf)
include(${CMAKE_CURRENT_LIST_DIR}/aureole_optics-targets.cmake)
