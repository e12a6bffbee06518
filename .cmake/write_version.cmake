# Script of the target mixbeam_version_header; works without git and outside a repository.

set(HASH "unknown")
set(DATE "unknown")
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" log -1 --format=%h,%cs
                  OUTPUT_VARIABLE commit RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed AND commit MATCHES "^([^,]+),(.+)$")
    set(HASH "${CMAKE_MATCH_1}")
    set(DATE "${CMAKE_MATCH_2}")
  endif()
endif()
configure_file("${SOURCE_DIR}/.cmake/version.hpp.in" "${HEADER}" @ONLY) # writes only if the content changed
