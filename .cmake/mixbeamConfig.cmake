# find_package(mixbeam): the target mixbeam::mixbeam, for #include <mixbeam/mixbeam.hpp>.
get_filename_component(mixbeam_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
# The program that loads the library provides HDF5: that of the archive, or Debian's.
file(GLOB mixbeam_own_hdf5 "${mixbeam_prefix}/lib/mixbeam/libhdf5_openmpi*.so.*")
find_library(mixbeam_HDF5 NAMES libhdf5_openmpi.so.103 libhdf5_openmpi.so)
if(mixbeam_own_hdf5)
  set(mixbeam_HDF5 "${mixbeam_own_hdf5}")
endif()
mark_as_advanced(mixbeam_HDF5)
if(NOT mixbeam_HDF5)
  set(mixbeam_FOUND FALSE)
  set(mixbeam_NOT_FOUND_MESSAGE "HDF5 for Open MPI was not found (Debian 12: apt-get install libhdf5-openmpi-103-1)")
  return()
endif()
if(NOT TARGET mixbeam::mixbeam)
  add_library(mixbeam::mixbeam SHARED IMPORTED)
  set_target_properties(mixbeam::mixbeam PROPERTIES
    IMPORTED_LOCATION "${mixbeam_prefix}/lib/mixbeam/libmixbeam.so"
    IMPORTED_LINK_DEPENDENT_LIBRARIES "${mixbeam_HDF5}"
    INTERFACE_INCLUDE_DIRECTORIES "${mixbeam_prefix}/include")
  target_compile_features(mixbeam::mixbeam INTERFACE cxx_std_17)
  # DT_RPATH also applies to the libraries of the library.
  target_link_options(mixbeam::mixbeam INTERFACE LINKER:--disable-new-dtags "LINKER:-rpath,${mixbeam_prefix}/lib/mixbeam"
                      "LINKER:-rpath-link,${mixbeam_prefix}/lib/mixbeam")
  target_link_libraries(mixbeam::mixbeam INTERFACE "-Wl,--push-state,--no-as-needed" "${mixbeam_HDF5}" "-Wl,--pop-state")
endif()
