# Compiler flags of mixbeam's own code, inherited through the folder targets.

add_library(mixbeam_options INTERFACE)
target_include_directories(mixbeam_options INTERFACE "${CMAKE_SOURCE_DIR}") # #include "kernels/math/rotation.hpp"
target_compile_options(mixbeam_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow)
# The Python module is a shared library made of the same objects as the programs: one set of objects, the same bits.
target_compile_options(mixbeam_options INTERFACE -fPIC -fno-semantic-interposition)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # With -O3, GCC 12 issues these two for correct uses of std::vector::insert and of std::string's operator+, inside the
  # standard library. The preset "asan" detects such errors.
  target_compile_options(mixbeam_options INTERFACE -Wno-stringop-overflow -Wno-restrict)
  if(MIXBEAM_INSTRUCTIONS STREQUAL "x86-64-v2") # lanes of a pair are set one by one
    target_compile_options(mixbeam_options INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
if(MIXBEAM_WARNINGS_AS_ERRORS)
  target_compile_options(mixbeam_options INTERFACE -Werror)
endif()

# -fno-math-errno lets std::sqrt be one instruction, -fno-trapping-math lets comparisons be vectorised; both keep NaN
# and infinity as in IEEE 754. -ffast-math would not: it deletes NaN checks and reorders sums. Fused multiply-add (the
# compiler's default where the processor has it) changes last digits between machines and between two compiled copies of
# a formula, not between thread counts: see for_each_index in kernels/execution/openmp_threads.hpp.
set(mixbeam_release_flags -fno-math-errno -fno-trapping-math)
if(MIXBEAM_INSTRUCTIONS)
  list(APPEND mixbeam_release_flags -march=${MIXBEAM_INSTRUCTIONS})
endif()
target_compile_options(mixbeam_options INTERFACE "$<$<CONFIG:Release>:${mixbeam_release_flags}>")

if(MIXBEAM_SANITIZE)
  set(mixbeam_sanitizer_flags -fsanitize=address,undefined -fno-omit-frame-pointer)
  # With its checks inlined, one instance of the element takes the compiler 100 s and more; without, 13 s.
  target_compile_options(mixbeam_options INTERFACE ${mixbeam_sanitizer_flags} -fno-sanitize-recover=undefined -fno-inline)
  target_link_options(mixbeam_options INTERFACE ${mixbeam_sanitizer_flags})
endif()

# For targets without loops over elements: input, control, output. -O1 halves the compile time of -O3. Files with loops
# over elements or vertices are passed to mixbeam_optimise.
set(mixbeam_light_code $<$<CONFIG:Release>:-O1>) # follows -O3; the last option counts
