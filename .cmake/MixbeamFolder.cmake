# mixbeam_add_folder(<target> <dependency>...)
#
# Library of the current folder: a static library of its *.cpp, or an interface library as long as it has only headers.
# Each header is compiled alone by the target verify_headers.

function(mixbeam_add_folder target)
  file(GLOB sources CONFIGURE_DEPENDS "*.cpp")
  file(GLOB headers CONFIGURE_DEPENDS "*.hpp")
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
