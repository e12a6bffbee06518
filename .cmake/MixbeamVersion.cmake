# Target mixbeam_version: generates the header mixbeam/version.hpp at each build, rewritten only if the commit changed.

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type_upper)
set(stamped_flags ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type_upper}})
if(build_type_upper STREQUAL "RELEASE")
  list(APPEND stamped_flags ${mixbeam_release_flags})
endif()
list(APPEND stamped_flags ${mixbeam_sanitizer_flags})
list(JOIN stamped_flags " " stamped_flags)

find_package(Git QUIET)
set(version_header "${CMAKE_BINARY_DIR}/generated/mixbeam/version.hpp")
add_custom_target(mixbeam_version_header
  COMMAND "${CMAKE_COMMAND}"
          "-DSOURCE_DIR=${CMAKE_SOURCE_DIR}" "-DHEADER=${version_header}" "-DGIT=${GIT_EXECUTABLE}"
          "-DVERSION=${PROJECT_VERSION}" "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          "-DFLAGS=${stamped_flags}" "-DINSTRUCTIONS=${MIXBEAM_INSTRUCTIONS}" "-DBUILD_TYPE=${CMAKE_BUILD_TYPE}"
          -P "${CMAKE_SOURCE_DIR}/.cmake/write_version.cmake"
  BYPRODUCTS "${version_header}"
  COMMENT "Stamping the version"
  VERBATIM)

add_library(mixbeam_version INTERFACE)
target_include_directories(mixbeam_version INTERFACE "${CMAKE_BINARY_DIR}/generated")
add_dependencies(mixbeam_version mixbeam_version_header)
