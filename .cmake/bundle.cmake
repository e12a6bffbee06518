# Runs at installation (MixbeamPackages): copies the shared libraries that the installed files need beside them, except
# those of glibc, under unique names; Open MPI's plugins and texts; and all licences, as in Debian's packages.

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
# Without plugins for special network hardware, batch systems and OpenSHMEM, which need further libraries.
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
# The loader uses the path of the program or module, which a path in a library would override. In a Python process
# plugins would not find their libraries that way, so they keep a path.
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

# --- Names of their own -------------------------------------------------------------------------------------------------
# A Python process loads one library per name, that of the first module: without unique names mixbeam would get other
# builds of its libraries, and other modules would get these. Libraries that every process shares keep their names
# (OF_SYSTEM in make_wheel.py).
function(patchelf)
  execute_process(COMMAND patchelf ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Debian's libxml2 uses iconv first, and ICU for encodings unknown to iconv. Unless anything else needs ICU, its 31 MB
# of data are replaced by an empty table of contents, with which ICU reports that it has no such encoding.
set(needs_icu "")
foreach(file IN LISTS copies copied_plugins)
  execute_process(COMMAND patchelf --print-needed "${file}" OUTPUT_VARIABLE needed COMMAND_ERROR_IS_FATAL ANY)
  cmake_path(GET file FILENAME name)
  if(needed MATCHES "libicu" AND NOT name MATCHES "^libicu")
    list(APPEND needs_icu "${name}")
  endif()
endforeach()
set(data ${copies})
list(FILTER data INCLUDE REGEX "/libicudata[.]so[.][0-9]+$")
if(data AND needs_icu STREQUAL "libxml2.so.2")
  cmake_path(GET data FILENAME name)
  string(REGEX REPLACE ".*[.]" "" version "${name}")
  set(source "${libraries}/empty_icu_data.c")
  # Header: its size, two marks, then size, format "ToCP" and its version of what follows; no entries.
  file(WRITE "${source}" "const _Alignas(16) unsigned char icudt${version}_dat[64] = {\n"
       "  [0] = 32, [2] = 0xda, [3] = 0x27, [4] = 20, [10] = 2, [12] = 'T', [13] = 'o', [14] = 'C', [15] = 'P', [16] = 1};\n")
  execute_process(COMMAND "${compiler}" -shared -nostdlib -s -Wl,-soname,${name} -o "${data}" "${source}"
                  COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE "${source}")
endif()

set(renamed "")
foreach(copy IN LISTS copies)
  cmake_path(GET copy FILENAME name)
  if(NOT name MATCHES "^lib(stdc[+][+]|gcc_s|z)[.]so")
    file(SHA256 "${copy}" sum)
    string(SUBSTRING "${sum}" 0 8 sum)
    string(REGEX REPLACE "[.]so" "-${sum}.so" own_name "${name}")
    file(RENAME "${copy}" "${libraries}/${own_name}")
    patchelf(--set-soname "${own_name}" "${libraries}/${own_name}")
    list(APPEND renamed --replace-needed "${name}" "${own_name}")
  endif()
endforeach()
file(GLOB patched "${prefix}/bin/mixbeam" "${libraries}/*.so*" "${libraries}/glibc-hwcaps/*/*.so" "${libraries}/mpi/orterun")
patchelf(${renamed} ${patched} ${copied_plugins})

# --- Licences -----------------------------------------------------------------------------------------------------------
set(packages "")
foreach(original IN LISTS originals)
  # Folders of / may be links to /usr; packages name either path.
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
