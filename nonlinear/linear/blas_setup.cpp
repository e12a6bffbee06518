#include "nonlinear/linear/blas_setup.hpp"

#include <Kokkos_Core.hpp>

#include <dlfcn.h>
#include <sys/mman.h>

#include <array>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

namespace mixbeam {

namespace {

template <class Function>
Function* found(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

#if defined(__x86_64__)
/// Better kernels, if OpenBLAS chose those for unknown processors; else null.
const char* better_kernels(const std::string& chosen) {
  if (chosen != "Prescott" && chosen != "Unknown") return nullptr;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl"))
    return "SkylakeX";
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "Haswell" : nullptr;
}

/// Restarts OpenBLAS with the variable set, which it reads at initialisation only.
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

/// Size of OpenBLAS's work buffers, of which it allocates and keeps one for each thread that is inside it. [byte]
constexpr std::size_t kRoomOfBlas = std::size_t{32} << 22;
int rooms_taken = 0;

using TakeRoom = void*(int);

/// Makes OpenBLAS allocate this many buffers, which it does not touch before use; false: there is no address space for
/// them. The space is probed first because OpenBLAS retries a failed allocation for ever.
bool take_rooms(int count) {
  const auto take = found<TakeRoom>("blas_memory_alloc");
  const auto give_back = found<void(void*)>("blas_memory_free");
  if (take == nullptr || give_back == nullptr || count <= rooms_taken) return true;
  const std::size_t more = static_cast<std::size_t>(count - rooms_taken) * kRoomOfBlas;
  void* const probe = mmap(nullptr, more, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (probe == MAP_FAILED) return false;
  munmap(probe, more);
  std::vector<void*> rooms(count);
  for (void*& room : rooms) room = take(1);
  for (void* room : rooms) give_back(room);
  rooms_taken = count;
  return true;
}

/// Not a LinearSolverError, after which other factorisations would be tried.
struct NoRoomForBlas : std::bad_alloc {
  const char* what() const noexcept override {
    return "OpenBLAS works in a buffer of 134 MB of addresses, which the limit of memory (ulimit -v or -d) does not "
           "leave; allowed: a limit that is higher by that";
  }
};

}  // namespace

double blas_room_to_come() {
  return rooms_taken == 0 && found<TakeRoom>("blas_memory_alloc") != nullptr ? static_cast<double>(kRoomOfBlas) : 0.0;
}

void set_up_blas() {
  using SetNumber = void(int);
  static const std::array<SetNumber*, 3> known = {found<SetNumber>("openblas_set_num_threads"),
                                                  found<SetNumber>("MKL_Set_Num_Threads"),
                                                  found<SetNumber>("bli_thread_set_num_threads")};
  for (SetNumber* const set_number : known)
    if (set_number != nullptr) set_number(1);  // each time: a host may have chosen another since
  static std::once_flag once;
  std::call_once(once, [] {
    choose_kernels();
    if (!take_rooms(1)) throw NoRoomForBlas();
  });
}

std::unique_lock<std::mutex> turn_for_blas() {
  static std::mutex turn;
  static const bool is_sequential = [] {
    const auto kind = found<int()>("openblas_get_parallel");
    return (kind != nullptr && kind() == 0) || !take_rooms(Kokkos::DefaultHostExecutionSpace().concurrency());
  }();
  return is_sequential ? std::unique_lock<std::mutex>(turn) : std::unique_lock<std::mutex>();
}

}  // namespace mixbeam
