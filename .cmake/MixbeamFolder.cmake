# mixbeam_add_folder(<target> <dependency>...)
#
# Adds a static library of the *.cpp in the current folder and its rooms. The target verify_headers compiles each header
# alone.

function(mixbeam_add_folder target)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "*.cpp")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS "*.hpp")
  if(sources)
    set(scope PUBLIC)
    add_library(${target} STATIC ${sources})
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  if(headers)
    target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS "${CMAKE_SOURCE_DIR}" FILES ${headers})
  endif()
  target_link_libraries(${target} ${scope} mixbeam_options ${ARGN})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
endfunction()

# mixbeam_optimise(<target> <file>...)
#
# Compiles these files of the target with -O3 in unity builds, independent of the options of the others. Without
# precompiled headers: GCC 12 crashes on those read with another optimisation level.
set(mixbeam_optimised_at_once 4)
function(mixbeam_optimise target)
  get_target_property(sources ${target} SOURCES)
  list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE files)
  list(REMOVE_ITEM sources ${files})
  set_target_properties(${target} PROPERTIES SOURCES "${sources}")
  add_library(${target}_loops OBJECT ${files})
  get_target_property(dependencies ${target} LINK_LIBRARIES)
  target_link_libraries(${target}_loops PRIVATE ${dependencies})
  set_target_properties(${target}_loops PROPERTIES UNITY_BUILD ${MIXBEAM_JOIN_SOURCES}
                                                   UNITY_BUILD_BATCH_SIZE ${mixbeam_optimised_at_once})
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_loops>)
endfunction()
