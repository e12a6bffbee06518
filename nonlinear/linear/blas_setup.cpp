#include "nonlinear/linear/blas_setup.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <string>

namespace mixbeam {

namespace {

template <class Function>
Function* found(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

#if defined(__x86_64__)
/// What OpenBLAS takes for processors that it does not know, and what serves them better.
const char* better_kernels(const std::string& chosen) {
  if (chosen != "Prescott" && chosen != "Unknown") return nullptr;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl"))
    return "SkylakeX";
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "Haswell" : nullptr;
}

/// The library reads the variable when it begins; it is made to begin again.
void choose_kernels() {
  constexpr const char* kVariable = "OPENBLAS_CORETYPE";
  const auto name = found<char*()>("openblas_get_corename");
  const auto quit = found<void()>("gotoblas_dynamic_quit"), begin = found<void()>("gotoblas_dynamic_init");
  if (name == nullptr || quit == nullptr || begin == nullptr || std::getenv(kVariable) != nullptr) return;
  const char* const kernels = better_kernels(name());
  if (kernels == nullptr) return;
  setenv(kVariable, kernels, 1);
  quit();
  begin();
  unsetenv(kVariable);
}
#else
void choose_kernels() {}
#endif

}  // namespace

void set_up_blas() {
  for (const char* name : {"openblas_set_num_threads", "MKL_Set_Num_Threads", "bli_thread_set_num_threads"})
    if (const auto set_number = found<void(int)>(name)) set_number(1);
  static std::once_flag once;
  std::call_once(once, choose_kernels);
}

std::unique_lock<std::mutex> turn_for_blas() {
  static std::mutex turn;
  static const bool is_sequential = [] {
    const auto kind = found<int()>("openblas_get_parallel");
    return kind != nullptr && kind() == 0;
  }();
  return is_sequential ? std::unique_lock<std::mutex>(turn) : std::unique_lock<std::mutex>();
}

}  // namespace mixbeam
