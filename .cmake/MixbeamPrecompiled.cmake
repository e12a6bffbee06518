# mixbeam_precompile(<target> <header>...)        reads these headers once for all files of the target
# mixbeam_precompile(<target> REUSE <other>)      takes what another target has read; the compiler flags must agree
#
# Most of the compile time is spent on Trilinos' headers. Only headers of other projects are precompiled: an edit of one
# of our own would recompile everything. (tpetra_types.hpp names the types of Tpetra that are used, so that their
# templates are instantiated once too; nearly everything includes it anyway.) Off with MIXBEAM_JOIN_SOURCES, so that a
# build without it shows the includes that a file forgot.

set(mixbeam_kokkos_headers <Kokkos_Core.hpp> <array> <cmath> <functional> <memory> <optional> <string> <vector>)
set(mixbeam_trilinos_headers
    ${mixbeam_kokkos_headers} <algorithm> <filesystem> <iostream> <map> <sstream> <stdexcept>
    <Teuchos_ParameterList.hpp> <Teuchos_XMLParameterListHelpers.hpp> <Teuchos_CommHelpers.hpp>
    <Tpetra_Core.hpp> <Tpetra_CrsMatrix.hpp> <Tpetra_Import.hpp> <Tpetra_Map.hpp> <Tpetra_Vector.hpp>
    <LOCA.H> <LOCA_Abstract_Group.H> <LOCA_Stepper.H> <NOX_Solver_Generic.H>
    "${CMAKE_SOURCE_DIR}/discretization/mesh/tpetra_types.hpp")

function(mixbeam_precompile target)
  if(NOT MIXBEAM_JOIN_SOURCES)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "REUSE" "")
  if(arg_REUSE)
    target_precompile_headers(${target} REUSE_FROM ${arg_REUSE})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess) # otherwise ccache does not cache such files
  endif()
endfunction()
