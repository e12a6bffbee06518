# Run at installation (MixbeamPackages): puts the shared libraries that the installed files need beside them, but those of
# glibc; Open MPI's plugins and texts; and the licences of all of them, as Debian's packages state them.

set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
set(libraries "${prefix}/${library_folder}")
set(licences "${prefix}/share/doc/mixbeam/licences")

# --- Open MPI -----------------------------------------------------------------------------------------------------------
cmake_path(GET mpiexec PARENT_PATH mpi_programs)
function(mpi_path result kind)
  execute_process(COMMAND "${mpi_programs}/ompi_info" --path ${kind} --parsable OUTPUT_VARIABLE line
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE ".*:" "" path "${line}")
  set(${result} "${path}" PARENT_SCOPE)
endfunction()
mpi_path(mpi_prefix prefix)
mpi_path(mpi_plugins pkglibdir)
mpi_path(mpi_texts pkgdatadir)
file(RELATIVE_PATH plugin_folder "${mpi_prefix}" "${mpi_plugins}")
file(RELATIVE_PATH text_folder "${mpi_prefix}" "${mpi_texts}")
# Without those for networks of special hardware, batch systems and OpenSHMEM, which bring libraries of their own.
file(GLOB plugins "${mpi_plugins}/mca_*.so")
list(FILTER plugins EXCLUDE REGEX
     "_(ofi|ucx|psm2?|openib|verbs|usnic|monitoring|slurm|flux|lsf|tm|portals4|oshmem)[.]so$|/mca_(atomic|memheap|scoll|spml|sshmem)_")
file(INSTALL ${plugins} DESTINATION "${libraries}/mpi/${plugin_folder}")
file(GLOB texts "${mpi_texts}/*.txt")
file(INSTALL ${texts} DESTINATION "${libraries}/mpi/${text_folder}")
file(COPY_FILE "${mpi_programs}/orterun" "${libraries}/mpi/orterun")
file(WRITE "${prefix}/bin/mixbeam-mpirun" [=[
#!/bin/sh
# mpirun of the libraries of this package: mixbeam-mpirun -n 2 mixbeam run SCENE
libraries=$(cd "$(dirname "$(readlink -f "$0")")/../lib/mixbeam" && pwd)
export PMIX_MCA_pcompress_base_silence_warning=1 OPAL_PREFIX="$libraries/mpi" LD_LIBRARY_PATH="$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
command -v ssh >/dev/null || export OMPI_MCA_plm=isolated # which it asks for even where this machine is the only one
exec "$libraries/mpi/orterun" "$@"
]=])
file(CHMOD "${prefix}/bin/mixbeam-mpirun" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
     WORLD_READ WORLD_EXECUTE)

# --- Libraries ----------------------------------------------------------------------------------------------------------
file(GET_RUNTIME_DEPENDENCIES
     EXECUTABLES "${prefix}/bin/mixbeam" "${libraries}/mpi/orterun"
     LIBRARIES "${libraries}/libmixbeam.so" "${libraries}/libmixbeam_python.so" MODULES ${plugins}
     PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|dl|rt|pthread|resolv|util|mvec|anl)[.]so" "^libmixbeam"
     RESOLVED_DEPENDENCIES_VAR found UNRESOLVED_DEPENDENCIES_VAR missing CONFLICTING_DEPENDENCIES_PREFIX found_twice)
if(missing)
  message(FATAL_ERROR "These libraries were not found: ${missing}")
endif()
foreach(name IN LISTS found_twice_FILENAMES)
  list(GET found_twice_${name} 0 first)
  list(APPEND found "${first}")
endforeach()
set(originals ${plugins} "${mpi_programs}/orterun")
foreach(library IN LISTS found)
  cmake_path(GET library FILENAME name)
  file(REAL_PATH "${library}" original)
  file(COPY_FILE "${original}" "${libraries}/${name}" ONLY_IF_DIFFERENT)
  list(APPEND originals "${original}")
  list(APPEND copies "${libraries}/${name}")
endforeach()
# The loader looks where the program or module says; a path of a library's own would keep it from that. What a plugin needs
# it would not find there in a process of Python: plugins keep their place for a path.
foreach(copy IN LISTS copies ITEMS "${libraries}/mpi/orterun")
  file(RPATH_REMOVE FILE "${copy}")
endforeach()
file(RELATIVE_PATH from_plugins "${libraries}/mpi/${plugin_folder}" "${libraries}")
file(GLOB copied_plugins "${libraries}/mpi/${plugin_folder}/*.so")
foreach(copy IN LISTS copied_plugins)
  set(path "")
  file(READ_ELF "${copy}" RUNPATH path)
  if(path)
    file(RPATH_CHANGE FILE "${copy}" OLD_RPATH "${path}" NEW_RPATH "$ORIGIN/${from_plugins}")
  endif()
endforeach()

# --- Licences -----------------------------------------------------------------------------------------------------------
set(packages "")
foreach(original IN LISTS originals)
  # A folder of / that is a link to one of /usr: a package says either.
  string(REGEX REPLACE "^/usr" "" elsewhere "${original}")
  foreach(path IN ITEMS "${original}" "${elsewhere}")
    execute_process(COMMAND dpkg-query --search "${path}" OUTPUT_VARIABLE owner ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      break()
    endif()
  endforeach()
  if(failed)
    message(FATAL_ERROR "No package of Debian has ${original}, whose licence has to be in the package")
  endif()
  string(REGEX REPLACE ":.*" "" owner "${owner}")
  list(APPEND packages ${owner})
endforeach()
list(REMOVE_DUPLICATES packages)
list(SORT packages)
foreach(package IN LISTS packages)
  file(REAL_PATH "/usr/share/doc/${package}/copyright" text)
  file(MAKE_DIRECTORY "${licences}")
  file(COPY_FILE "${text}" "${licences}/${package}.txt")
endforeach()
