# Finds the libraries that mixbeam uses and wraps them in interface targets:
#
#   mixbeam_kokkos     Kokkos core and OpenMP: all that kernels/ may use
#   mixbeam_trilinos   mixbeam_kokkos + Teuchos, Tpetra, Amesos2, Belos, NOX, LOCA and MPI
#   mixbeam_metis      METIS: parts of networks for ranks, and the order of MUMPS' eliminations: Debian's is built without
#   mixbeam_hdf5       HDF5: its archive in programs, the shared library in the Python module
#   mixbeam_mumps      MUMPS: the symmetric factorisation that counts negative pivots, which no solver behind Amesos2 does
#   mixbeam_nlopt      NLopt, its part in C: minima under constraints
#   mixbeam_sacado     automatic differentiation, for tests
#
# Trilinos is looked up by header and library instead of by find_package(Trilinos): the exported configuration of Debian
# refers to sixteen packages that mixbeam does not use, and puts 38 libraries on the link line, all of which an
# executable would load at each start. Set CMAKE_PREFIX_PATH to use another installation.

set(MPI_CXX_SKIP_MPICXX ON) # C++ bindings, removed from MPI in 2012: each file would compile their virtual tables
find_package(MPI REQUIRED COMPONENTS CXX)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(LibXml2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(GSL REQUIRED)
find_package(muparser CONFIG REQUIRED)
find_package(yaml-cpp CONFIG REQUIRED)

# --- HDF5: the variant that Trilinos links, which is the one built for Open MPI -----------------------------------------
set(HDF5_PREFER_PARALLEL TRUE)
find_package(HDF5 REQUIRED COMPONENTS C)
if(NOT HDF5_IS_PARALLEL)
  message(FATAL_ERROR "mixbeam needs the Open MPI variant of HDF5, but found a serial one in ${HDF5_INCLUDE_DIRS}.\n"
                      "On Debian 12: apt-get install libhdf5-openmpi-dev")
endif()
# Programs link its archive if there is one: the shared library needs curl and SSL for files in object stores, and
# loading thirty libraries would take a quarter of each start. Debian's archive is not suitable for modules.
get_target_property(hdf5_library hdf5::hdf5 IMPORTED_LOCATION)
cmake_path(GET hdf5_library PARENT_PATH hdf5_folder)
find_library(HDF5_ARCHIVE NAMES libhdf5.a PATHS "${hdf5_folder}" NO_DEFAULT_PATH DOC "Archive of HDF5")
find_library(SZ_LIBRARY NAMES sz DOC "SZIP compression, for HDF5's archive")
find_library(Z_LIBRARY NAMES z DOC "zlib, for HDF5's archive")
mark_as_advanced(HDF5_ARCHIVE SZ_LIBRARY Z_LIBRARY)
add_library(mixbeam_hdf5 INTERFACE)
target_include_directories(mixbeam_hdf5 SYSTEM INTERFACE
                           "$<TARGET_PROPERTY:hdf5::hdf5,INTERFACE_INCLUDE_DIRECTORIES>")
if(HDF5_ARCHIVE AND SZ_LIBRARY AND Z_LIBRARY)
  set(mixbeam_hdf5_module "${hdf5_library}")
  set(mixbeam_hdf5_program "${HDF5_ARCHIVE}" "${SZ_LIBRARY}" "${Z_LIBRARY}" ${CMAKE_DL_LIBS})
else()
  set(mixbeam_hdf5_module hdf5::hdf5)
  set(mixbeam_hdf5_program hdf5::hdf5)
endif()
# The shared library of a package uses the HDF5 of the program or module that loads it.
set(consumer "$<TARGET_PROPERTY:TYPE>")
target_link_libraries(mixbeam_hdf5 INTERFACE "$<$<STREQUAL:${consumer},MODULE_LIBRARY>:${mixbeam_hdf5_module}>"
                                             "$<$<STREQUAL:${consumer},EXECUTABLE>:${mixbeam_hdf5_program}>")

# --- xxHash: headers only; its functions are compiled for the processor of the build ------------------------------------
find_path(XXHASH_INCLUDE_DIR xxhash.h DOC "Folder of the xxHash header")
mark_as_advanced(XXHASH_INCLUDE_DIR)
if(NOT XXHASH_INCLUDE_DIR)
  message(FATAL_ERROR "mixbeam needs the header of xxHash 0.8 (xxhash.h), which was not found.\n"
                      "On Debian 12: apt-get install --no-install-recommends libxxhash-dev")
endif()

# --- MUMPS: the variant for Open MPI, the one Trilinos is linked with --------------------------------------------------
find_path(MUMPS_INCLUDE_DIR dmumps_c.h DOC "Folder of the MUMPS headers")
find_library(MUMPS_dmumps_LIBRARY NAMES dmumps DOC "MUMPS, double precision")
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_dmumps_LIBRARY)
if(NOT MUMPS_INCLUDE_DIR OR NOT MUMPS_dmumps_LIBRARY)
  message(FATAL_ERROR "mixbeam needs MUMPS (header dmumps_c.h, library dmumps), which was not found.\n"
                      "On Debian 12: apt-get install --no-install-recommends libmumps-dev\n"
                      "Elsewhere: point CMAKE_PREFIX_PATH to an installation of MUMPS 5 with MPI.")
endif()

find_path(METIS_INCLUDE_DIR metis.h DOC "Folder of the METIS header")
find_library(METIS_LIBRARY NAMES metis DOC "METIS")
mark_as_advanced(METIS_INCLUDE_DIR METIS_LIBRARY)
if(NOT METIS_INCLUDE_DIR OR NOT METIS_LIBRARY)
  message(FATAL_ERROR "mixbeam needs METIS (header metis.h, library metis), which was not found.\n"
                      "On Debian 12: apt-get install --no-install-recommends libmetis-dev\n"
                      "Elsewhere: point CMAKE_PREFIX_PATH to an installation of METIS 5.")
endif()

find_path(NLOPT_INCLUDE_DIR nlopt.h DOC "Folder of the NLopt header")
find_library(NLOPT_LIBRARY NAMES nlopt DOC "NLopt")
mark_as_advanced(NLOPT_INCLUDE_DIR NLOPT_LIBRARY)
if(NOT NLOPT_INCLUDE_DIR OR NOT NLOPT_LIBRARY)
  message(FATAL_ERROR "mixbeam needs NLopt (header nlopt.h, library nlopt), which was not found.\n"
                      "On Debian 12: apt-get install --no-install-recommends libnlopt-dev\n"
                      "Elsewhere: point CMAKE_PREFIX_PATH to an installation of NLopt 2.")
endif()

# --- Trilinos: headers -------------------------------------------------------------------------------------------------
set(required_trilinos_major 13)
set(missing_parts "")
set(missing_packages "")

function(note_missing part package)
  set(missing_parts "${missing_parts}\n    ${part}" PARENT_SCOPE)
  set(missing_packages "${missing_packages};${package}" PARENT_SCOPE)
endfunction()

find_path(TRILINOS_INCLUDE_DIR Teuchos_ParameterList.hpp PATH_SUFFIXES trilinos DOC "Folder of the Trilinos headers")
mark_as_advanced(TRILINOS_INCLUDE_DIR)

# Debian's packages do not depend on each other's development files, so every header that is included, directly or by
# another Trilinos header, is checked.
set(trilinos_headers
    Trilinos_version.h           trilinos-dev
    Teuchos_ParameterList.hpp    libtrilinos-teuchos-dev
    Kokkos_Core.hpp              libtrilinos-kokkos-dev
    KokkosKernels_config.h       libtrilinos-kokkos-kernels-dev
    Tpetra_Core.hpp              libtrilinos-tpetra-dev
    NOX.H                        libtrilinos-nox-dev
    LOCA.H                       libtrilinos-nox-dev
    Amesos2.hpp                  libtrilinos-amesos2-dev
    Thyra_VectorBase.hpp         libtrilinos-thyra-dev
    BelosMinresIter.hpp          libtrilinos-belos-dev
    Sacado.hpp                   libtrilinos-sacado-dev
    Epetra_Map.h                 libtrilinos-epetra-dev
    RTOpPack_Types.hpp           libtrilinos-rtop-dev
    AnasaziTypes.hpp             libtrilinos-anasazi-dev
    Tacho.hpp                    libtrilinos-shylu-dev)
while(trilinos_headers)
  list(POP_FRONT trilinos_headers header package)
  if(NOT TRILINOS_INCLUDE_DIR OR NOT EXISTS "${TRILINOS_INCLUDE_DIR}/${header}")
    note_missing("header ${header}" ${package})
  endif()
endwhile()

# --- Trilinos: libraries -----------------------------------------------------------------------------------------------
# Searches beside the headers first, so that headers and libraries come from one installation.
cmake_path(GET TRILINOS_INCLUDE_DIR PARENT_PATH trilinos_prefix)
function(find_trilinos_libraries result)
  set(files "")
  while(ARGN)
    list(POP_FRONT ARGN name package)
    find_library(TRILINOS_${name}_LIBRARY NAMES trilinos_${name} ${name}
                 HINTS "${trilinos_prefix}/lib" "${trilinos_prefix}/../lib" DOC "Trilinos library ${name}")
    mark_as_advanced(TRILINOS_${name}_LIBRARY)
    if(TRILINOS_${name}_LIBRARY)
      list(APPEND files "${TRILINOS_${name}_LIBRARY}")
    else()
      note_missing("library ${name}" ${package})
    endif()
  endwhile()
  set(${result} "${files}" PARENT_SCOPE)
  set(missing_parts "${missing_parts}" PARENT_SCOPE)
  set(missing_packages "${missing_packages}" PARENT_SCOPE)
endfunction()

find_trilinos_libraries(kokkos_libraries
    kokkoscontainers     libtrilinos-kokkos-dev
    kokkoscore           libtrilinos-kokkos-dev)
find_trilinos_libraries(trilinos_libraries
    loca                 libtrilinos-nox-dev
    nox                  libtrilinos-nox-dev
    belos                libtrilinos-belos-dev
    amesos2              libtrilinos-amesos2-dev
    tpetra               libtrilinos-tpetra-dev
    tpetraclassic        libtrilinos-tpetra-dev
    kokkoskernels        libtrilinos-kokkos-kernels-dev
    teuchoskokkoscomm    libtrilinos-teuchos-dev
    teuchoskokkoscompat  libtrilinos-teuchos-dev
    teuchosremainder     libtrilinos-teuchos-dev
    teuchosnumerics      libtrilinos-teuchos-dev
    teuchoscomm          libtrilinos-teuchos-dev
    teuchosparameterlist libtrilinos-teuchos-dev
    teuchosparser        libtrilinos-teuchos-dev
    teuchoscore          libtrilinos-teuchos-dev)
find_trilinos_libraries(sacado_libraries
    sacado               libtrilinos-sacado-dev)

# --- Trilinos: one message for whatever is wrong -------------------------------------------------------------------------
if(TRILINOS_INCLUDE_DIR AND EXISTS "${TRILINOS_INCLUDE_DIR}/Trilinos_version.h")
  file(STRINGS "${TRILINOS_INCLUDE_DIR}/Trilinos_version.h" version_line REGEX "define TRILINOS_VERSION_STRING")
  string(REGEX REPLACE ".*\"([^\"]*)\".*" "\\1" trilinos_version "${version_line}")
  if(NOT trilinos_version MATCHES "^${required_trilinos_major}(\\.|$)")
    message(FATAL_ERROR "mixbeam needs Trilinos ${required_trilinos_major} (Debian 12 has 13.2), but "
                        "${TRILINOS_INCLUDE_DIR} holds version ${trilinos_version}.\n"
                        "Point CMAKE_PREFIX_PATH to an installation of version ${required_trilinos_major}, "
                        "and configure into an empty build folder.")
  endif()
endif()
if(missing_parts)
  list(REMOVE_DUPLICATES missing_packages)
  list(JOIN missing_packages " " missing_packages)
  message(FATAL_ERROR "Parts of Trilinos were not found:${missing_parts}\n"
                      "On Debian 12: apt-get install --no-install-recommends${missing_packages}\n"
                      "Elsewhere: point CMAKE_PREFIX_PATH to an installation of Trilinos ${required_trilinos_major}.")
endif()
message(STATUS "Trilinos ${trilinos_version}: ${TRILINOS_INCLUDE_DIR}")

# --- Targets -----------------------------------------------------------------------------------------------------------
add_library(mixbeam_kokkos INTERFACE)
target_include_directories(mixbeam_kokkos SYSTEM INTERFACE "${TRILINOS_INCLUDE_DIR}")
target_link_libraries(mixbeam_kokkos INTERFACE ${kokkos_libraries} OpenMP::OpenMP_CXX ${CMAKE_DL_LIBS})
target_link_options(mixbeam_kokkos INTERFACE LINKER:--as-needed)

# Kokkos without a parallel host back end selects "atomic" operations that are not atomic. They are inline functions, so
# every file that includes Kokkos must select the real ones, or the linker keeps an arbitrary kind.
file(STRINGS "${TRILINOS_INCLUDE_DIR}/KokkosCore_config.h" kokkos_parallel_host
     REGEX "^#define KOKKOS_ENABLE_(OPENMP|THREADS|HPX)$")
if(NOT kokkos_parallel_host)
  target_compile_definitions(mixbeam_kokkos INTERFACE KOKKOS_ENABLE_GNU_ATOMICS)
endif()

add_library(mixbeam_trilinos INTERFACE)
target_link_libraries(mixbeam_trilinos INTERFACE ${trilinos_libraries} mixbeam_kokkos MPI::MPI_CXX)

add_library(mixbeam_metis INTERFACE)
target_include_directories(mixbeam_metis SYSTEM INTERFACE "${METIS_INCLUDE_DIR}")
target_link_libraries(mixbeam_metis INTERFACE "${METIS_LIBRARY}")

add_library(mixbeam_nlopt INTERFACE)
target_include_directories(mixbeam_nlopt SYSTEM INTERFACE "${NLOPT_INCLUDE_DIR}")
target_link_libraries(mixbeam_nlopt INTERFACE "${NLOPT_LIBRARY}")

add_library(mixbeam_mumps INTERFACE)
target_include_directories(mixbeam_mumps SYSTEM INTERFACE "${MUMPS_INCLUDE_DIR}")
target_link_libraries(mixbeam_mumps INTERFACE "${MUMPS_dmumps_LIBRARY}" MPI::MPI_CXX)

add_library(mixbeam_sacado INTERFACE)
target_link_libraries(mixbeam_sacado INTERFACE ${sacado_libraries} mixbeam_trilinos)
