#include "apps/thread_scaling/chain_unit.hpp"

#include "nonlinear/linear/blas_setup.hpp"

#include <dlfcn.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr int kBlock = 6;                       ///< unknowns of a vertex
constexpr int kDiagonals = 2 * kBlock - 1;      ///< on either side of the main diagonal
constexpr int kBandRows = 3 * kDiagonals + 1;   ///< of LAPACK's band storage, with fill-in of row exchanges
constexpr int kMainRow = 2 * kDiagonals;        ///< row of the main diagonal
constexpr double kAxial = 100.0, kTwist = 1.0;  ///< stiffness over bending stiffness; element length is one
/// Stiffness of the foundation over that of bending. Without it, the condition number of a clamped chain grows with the
/// fourth power of its length, and the solution could not be checked.
constexpr double kFoundation = 0.1;
/// Tolerance of the solution; condition times rounding is 1e-12.
constexpr double kUnitTolerance = 1e-9;

using ElementStiffness = std::array<std::array<double, 2 * kBlock>, 2 * kBlock>;

/// Euler-Bernoulli beam of unit length and bending stiffness; unknowns of an end: displacements, rotations.
ElementStiffness element_stiffness() {
  ElementStiffness k{};
  const auto spring = [&k](int i, double stiffness) {
    k[i][i] = k[i + kBlock][i + kBlock] = stiffness;
    k[i][i + kBlock] = k[i + kBlock][i] = -stiffness;
  };
  spring(0, kAxial);
  spring(3, kTwist);
  const auto bending = [&k](int deflection, int rotation, double sign) {
    const int at[4] = {deflection, rotation, deflection + kBlock, rotation + kBlock};
    const double s = 6.0 * sign;
    const double values[4][4] = {{12.0, s, -12.0, s}, {s, 4.0, -s, 2.0}, {-12.0, -s, 12.0, -s}, {s, 2.0, -s, 4.0}};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) k[at[i]][at[j]] = values[i][j];
  };
  bending(1, 5, 1.0);
  bending(2, 4, -1.0);
  return k;
}

/// The exact solution: of size one, varying from row to row.
double known_solution(int row) { return 1.0 + 0.5 * ((row * 7) % 11) / 11.0; }

namespace fs = std::filesystem;

/// LAPACK's band solver. B is a unit of time only if it does not depend on the BLAS chosen in the system. So Debian's
/// reference libraries are loaded if present, in a separate namespace because the program has loaded the chosen ones
/// already.
struct BandSolver {
  using Factorize = void (*)(const int* m, const int* n, const int* kl, const int* ku, double* ab, const int* ldab,
                             int* ipiv, int* info);
  using Solve = void (*)(const char* trans, const int* n, const int* kl, const int* ku, const int* nrhs,
                         const double* ab, const int* ldab, const int* ipiv, double* b, const int* ldb, int* info,
                         size_t trans_length);
  Factorize factorize;
  Solve solve;
  std::string blas;

  static const BandSolver& instance() {
    static const BandSolver solver;
    return solver;
  }

 private:
  BandSolver() {
    blas = library_of("dgemm_");
    const fs::path folder = fs::path(library_of("dgbtrf_")).parent_path().parent_path();
    void* library = RTLD_DEFAULT;
    const fs::path reference_blas = folder / "blas" / "libblas.so.3",
                   reference_lapack = folder / "lapack" / "liblapack.so.3";
    if (void* loaded = dlmopen(LM_ID_NEWLM, reference_blas.c_str(), RTLD_NOW)) {
      Lmid_t name_space = LM_ID_BASE;
      dlinfo(loaded, RTLD_DI_LMID, &name_space);
      if (void* lapack = dlmopen(name_space, reference_lapack.c_str(), RTLD_NOW)) {
        library = lapack;
        blas = canonical(reference_blas);
      }
    }
    factorize = reinterpret_cast<Factorize>(dlsym(library, "dgbtrf_"));
    solve = reinterpret_cast<Solve>(dlsym(library, "dgbtrs_"));
    if (factorize == nullptr || solve == nullptr) throw std::runtime_error("LAPACK has no solver for band matrices");
  }
  static std::string canonical(const fs::path& path) {
    std::error_code problem;
    const fs::path found = fs::canonical(path, problem);
    return problem ? path.string() : found.string();
  }
  static std::string library_of(const char* name) {
    void* function = dlsym(RTLD_DEFAULT, name);
    Dl_info info;
    if (function == nullptr || dladdr(function, &info) == 0 || info.dli_fname == nullptr) return "unknown";
    return canonical(info.dli_fname);
  }
};

/// Processor time of this thread only: threads of earlier kernels may still be spinning.
double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

ChainUnit::ChainUnit(int vertices)
    : vertices_(vertices),
      band_(static_cast<size_t>(kBandRows) * kBlock * vertices),
      rhs_(static_cast<size_t>(kBlock) * vertices),
      pivots_(static_cast<size_t>(kBlock) * vertices) {
  set_up_blas();
}

void ChainUnit::fill() {
  const ElementStiffness stiffness = element_stiffness();
  std::fill(band_.begin(), band_.end(), 0.0);
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  const auto add = [this](int i, int j, double value) {
    band_[static_cast<size_t>(kBandRows) * j + kMainRow + i - j] += value;
    rhs_[i] += value * known_solution(j);
  };
  for (int v = 0; v < vertices_; ++v)
    for (int i = 0; i < kBlock; ++i) add(kBlock * v + i, kBlock * v + i, kFoundation);
  for (int i = 0; i < kBlock; ++i)  // element between the clamp and the first vertex
    for (int j = 0; j < kBlock; ++j) add(i, j, stiffness[kBlock + i][kBlock + j]);
  for (int e = 0; e + 1 < vertices_; ++e)
    for (int i = 0; i < 2 * kBlock; ++i)
      for (int j = 0; j < 2 * kBlock; ++j) add(kBlock * e + i, kBlock * e + j, stiffness[i][j]);
}

ChainUnit::Seconds ChainUnit::time() {
  using Clock = std::chrono::steady_clock;
  fill();
  const BandSolver& lapack = BandSolver::instance();
  const int rows = kBlock * vertices_;
  int info[2] = {0, 0};
  const double processor_start = processor_seconds();
  const auto start = Clock::now();
  lapack.factorize(&rows, &rows, &kDiagonals, &kDiagonals, band_.data(), &kBandRows, pivots_.data(), &info[0]);
  const auto factorized = Clock::now();
  constexpr int kOne = 1;
  lapack.solve("N", &rows, &kDiagonals, &kDiagonals, &kOne, band_.data(), &kBandRows, pivots_.data(), rhs_.data(),
               &rows, &info[1], 1);
  const auto solved = Clock::now();
  const double processor = processor_seconds() - processor_start;
  double error = info[0] == 0 && info[1] == 0 ? 0.0 : HUGE_VAL;
  for (int i = 0; i < rows; ++i) error = std::max(error, std::abs(rhs_[i] - known_solution(i)));
  if (!(error <= kUnitTolerance)) throw std::runtime_error("LAPACK does not solve the chain that is the unit of time");
  return {std::chrono::duration<double>(factorized - start).count(),
          std::chrono::duration<double>(solved - factorized).count(), processor};
}

std::string blas_library() { return BandSolver::instance().blas; }

}  // namespace mixbeam
