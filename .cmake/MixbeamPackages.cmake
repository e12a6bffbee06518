# Installation, and the packages of the target "package":
#
#   mixbeam-VERSION-linux-x86_64.tar.xz   relocatable, with the libraries that it needs but those of glibc
#   mixbeam_VERSION_amd64.deb             for the Debian of the build
#   mixbeam-VERSION-cp3X-...whl           module for Python, with its libraries
#
# Program, Python module and C++ programs load libmixbeam.so, which a package contains for each instruction set: the
# loader takes the best one in lib/mixbeam/glibc-hwcaps/<level> for the processor, otherwise lib/mixbeam/libmixbeam.so.
# Each has its own build in <build>/levels; none belongs to "all".

set(MIXBEAM_FURTHER_LEVELS "" CACHE STRING "Build folders of further instruction sets, named after them, for a package")
mark_as_advanced(MIXBEAM_FURTHER_LEVELS)
set(mixbeam_levels x86-64-v2 x86-64-v3 x86-64-v4) # the first one is lib/mixbeam/libmixbeam.so

set(package_folder "${CMAKE_BINARY_DIR}/package")
set(library_folder lib/mixbeam)
set(module_folder lib/python3/dist-packages/mixbeam)

# --- libmixbeam.so and what loads it ------------------------------------------------------------------------------------
# DT_RPATH also applies to the libraries of libraries, unlike DT_RUNPATH: none of them needs its own.
function(mixbeam_packaged target folder)
  set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "${ARGN}"
                        LIBRARY_OUTPUT_DIRECTORY "${package_folder}/${folder}"
                        RUNTIME_OUTPUT_DIRECTORY "${package_folder}/${folder}")
  target_link_options(${target} PRIVATE LINKER:--disable-new-dtags LINKER:--strip-all)
  if(MIXBEAM_INSTRUCTIONS MATCHES "^x86-64-v") # without that set the loader prints an error instead of a crash
    target_link_options(${target} PRIVATE LINKER:-z,${MIXBEAM_INSTRUCTIONS})
  endif()
endfunction()

add_library(mixbeam_library SHARED apps/library/mixbeam.cpp)
set_property(TARGET mixbeam_library PROPERTY LINK_LIBRARY_OVERRIDE
             "WHOLE_ARCHIVE,mixbeam_runs,mixbeam_commands,apps_common,nonlinear,discretization,kernels")
target_link_libraries(mixbeam_library PRIVATE mixbeam_runs)
target_link_options(mixbeam_library PRIVATE LINKER:-Bsymbolic-functions) # binds internal calls directly
set_target_properties(mixbeam_library PROPERTIES OUTPUT_NAME mixbeam)
mixbeam_packaged(mixbeam_library lib)

add_executable(mixbeam_program apps/mixbeam/main.cpp)
target_include_directories(mixbeam_program PRIVATE $<TARGET_PROPERTY:mixbeam_commands,INCLUDE_DIRECTORIES>)
target_link_libraries(mixbeam_program PRIVATE mixbeam_options mixbeam_version mixbeam_library mixbeam_trilinos
                                              ${mixbeam_hdf5_program})
set_target_properties(mixbeam_program PROPERTIES OUTPUT_NAME mixbeam)
mixbeam_packaged(mixbeam_program bin "$ORIGIN/../${library_folder}")
set(mixbeam_packaged_targets mixbeam_program)

if(TARGET python_objects)
  add_library(python_library SHARED $<TARGET_OBJECTS:python_objects>)
  target_link_libraries(python_library PRIVATE mixbeam_library mixbeam_trilinos ${mixbeam_hdf5_module})
  set_target_properties(python_library PROPERTIES OUTPUT_NAME mixbeam_python LINKER_LANGUAGE CXX)
  mixbeam_packaged(python_library lib)

  # Python opens a file of this name and finds PyInit__core in the library that it depends on.
  file(WRITE "${package_folder}/core.c" "extern int nothing;\n")
  add_library(python_core MODULE "${package_folder}/core.c")
  target_link_libraries(python_core PRIVATE "-Wl,--push-state,--no-as-needed" python_library "-Wl,--pop-state")
  set_target_properties(python_core PROPERTIES OUTPUT_NAME _core PREFIX "")
  mixbeam_packaged(python_core python "$ORIGIN/lib" "$ORIGIN/../../../mixbeam") # in a wheel, and elsewhere
  list(APPEND mixbeam_packaged_targets python_core python)
endif()
add_custom_target(packaged)
add_dependencies(packaged ${mixbeam_packaged_targets})

# --- What is installed --------------------------------------------------------------------------------------------------
install(PROGRAMS "${package_folder}/bin/mixbeam" DESTINATION bin COMPONENT program)
install(FILES "${package_folder}/lib/libmixbeam.so" DESTINATION ${library_folder} COMPONENT program)
install(FILES "${package_folder}/lib/libmixbeam_python.so" DESTINATION ${library_folder} COMPONENT python)
foreach(folder IN LISTS MIXBEAM_FURTHER_LEVELS)
  cmake_path(GET folder FILENAME level)
  set(level_folder "${library_folder}/glibc-hwcaps/${level}")
  install(FILES "${folder}/package/lib/libmixbeam.so" DESTINATION "${level_folder}" COMPONENT program)
  install(FILES "${folder}/package/lib/libmixbeam_python.so" DESTINATION "${level_folder}" COMPONENT python)
endforeach()
install(FILES .cmake/completion.bash DESTINATION share/bash-completion/completions RENAME mixbeam COMPONENT program)
install(DIRECTORY apps/gallery DESTINATION share/mixbeam COMPONENT program
        FILES_MATCHING PATTERN "*.xml" PATTERN "*.yaml" PATTERN "*.csv")
install(DIRECTORY apps/docs/ DESTINATION share/doc/mixbeam COMPONENT program
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.yaml" PATTERN "*.csv")
install(FILES README.md CITATION.cff .cmake/copyright DESTINATION share/doc/mixbeam COMPONENT program)
# Scripts of plot, report and view are in the Python module too.
install(DIRECTORY apps/plots DESTINATION ${module_folder} COMPONENT program
        FILES_MATCHING PATTERN "*.py" PATTERN "*.js" PATTERN "*.css" PATTERN "*.html" PATTERN __pycache__ EXCLUDE)
install(DIRECTORY "${CMAKE_BINARY_DIR}/python/mixbeam/" DESTINATION ${module_folder} COMPONENT python
        FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN py.typed PATTERN __pycache__ EXCLUDE
        PATTERN plots EXCLUDE)
install(PROGRAMS "${package_folder}/python/_core.so" DESTINATION ${module_folder} COMPONENT python)

include(CMakePackageConfigHelpers)
write_basic_package_version_file("${package_folder}/mixbeamConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES .cmake/mixbeamConfig.cmake "${package_folder}/mixbeamConfigVersion.cmake" DESTINATION lib/cmake/mixbeam
        COMPONENT development)
install(FILES apps/library/mixbeam.hpp DESTINATION include/mixbeam COMPONENT development)

# Libraries of other projects, Open MPI's own files and the licences of all of them.
install(CODE "set(library_folder ${library_folder})\nset(mpiexec ${MPIEXEC_EXECUTABLE})\nset(compiler ${CMAKE_C_COMPILER})" COMPONENT bundle EXCLUDE_FROM_ALL)
install(SCRIPT .cmake/bundle.cmake COMPONENT bundle EXCLUDE_FROM_ALL)

# --- Packages -----------------------------------------------------------------------------------------------------------
if(MIXBEAM_FURTHER_LEVELS)
  set(Python_EXECUTABLE /usr/bin/python3) # as in apps/python
  find_package(Python REQUIRED COMPONENTS Interpreter)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_PACKAGE_NAME mixbeam)
  set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
  set(CPACK_PACKAGE_VENDOR mixbeam)
  set(CPACK_PACKAGE_CONTACT "mixbeam")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Static solver for structures of geometrically exact beams")
  set(CPACK_PACKAGE_FILE_NAME mixbeam-${PROJECT_VERSION}-linux-x86_64)
  set(CPACK_GENERATOR TXZ DEB)
  set(CPACK_THREADS 2)
  set(CPACK_DEBIAN_FILE_NAME mixbeam_${PROJECT_VERSION}_amd64.deb)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor})")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${package_folder}/lib")
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-matplotlib, python3-h5py")
  set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_SOURCE_DIR}/.cmake/package_contents.cmake")
  include(CPack)
else()
  # Checked before three quarters of an hour of builds, after which it is needed.
  set(missing "Packages need patchelf: apt-get install patchelf")
  set(commands COMMAND sh -c "command -v patchelf >/dev/null || (echo '${missing}' >&2 && false)")
  list(TRANSFORM mixbeam_levels PREPEND "${CMAKE_BINARY_DIR}/levels/" OUTPUT_VARIABLE folders)
  list(POP_FRONT folders base)
  list(JOIN folders "$<SEMICOLON>" further)
  foreach(level IN LISTS mixbeam_levels)
    set(folder "${CMAKE_BINARY_DIR}/levels/${level}")
    list(APPEND commands
         COMMAND "${CMAKE_COMMAND}" -S "${CMAKE_SOURCE_DIR}" -B "${folder}" -G "${CMAKE_GENERATOR}" --log-level=NOTICE
                 -DCMAKE_BUILD_TYPE=Release -DMIXBEAM_INSTRUCTIONS=${level} -DBUILD_TESTING=OFF
                 "-DMIXBEAM_FURTHER_LEVELS=${further}"
         COMMAND "${CMAKE_COMMAND}" --build "${folder}" --target packaged)
  endforeach()
  add_custom_target(package ${commands}
    COMMAND "${CMAKE_CPACK_COMMAND}" --config "${base}/CPackConfig.cmake" -B "${CMAKE_BINARY_DIR}/packages"
    COMMAND /usr/bin/python3 "${CMAKE_SOURCE_DIR}/.cmake/make_wheel.py"
            "${CMAKE_BINARY_DIR}/packages/mixbeam-${PROJECT_VERSION}-linux-x86_64.tar.xz"
    USES_TERMINAL VERBATIM COMMENT "Packages, in ${CMAKE_BINARY_DIR}/packages")
endif()
