/// Location of load factors at which natural frequencies meet and become complex, or separate again, under loads
/// without a potential and in rotating frames: theory (74).
#pragma once

#include "nonlinear/path/corrector.hpp"
#include "nonlinear/stability/stability.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace mixbeam {

/// Whether frequencies may be complex: some load follows the structure or is a moment, or there is a rotating frame.
bool may_flutter(const Scene& scene);

/// Examines each state of a path in turn, and one half-way between two. Sees only the frequencies that the analysis
/// requests, and a few more.
class FlutterFinder {
 public:
  FlutterFinder(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters);

  /// Finds the points since the previous state at which more or fewer frequencies became complex. States in between are
  /// computed by Newton's method from a neighbour. `held`: the state is a minimum of a potential, about which no motion
  /// grows; nothing is sought between two such states. Empty if there are no masses, or frequencies cannot be computed.
  /// Collective.
  std::vector<CriticalPoint> passed(const State& state, double load_factor, bool held);

 private:
  /// Squares of frequencies about a state, in the order of vibration_modes(), or exponents of damped motions.
  struct Sample {
    State state;
    double load_factor = 0.0;
    std::vector<std::complex<double>> squared{}, rates{};
    std::vector<MixedVector> modes{};

    int complex_values() const;
    int growing() const;            ///< number of growing motions
    double largest_growth() const;  ///< largest rate of growth, over a scale whose rounding is that of numbers near one
    size_t most_growing() const;    ///< index of the largest rate
    double largest_rate() const { return rates.empty() ? 0.0 : rates[most_growing()].real(); }
  };
  /// Frequencies that meet, which are neighbours.
  struct Cluster {
    size_t first = 0, count = 0;
    std::complex<double> mean(const Sample& sample) const;
    double discriminant(const Sample& sample) const;
  };

  Sample look(const State& state, double load_factor) const;
  std::optional<CriticalPoint> entered(Sample low, const Sample& high);
  std::optional<Sample> between(const Sample& from, double load_factor);
  static Cluster cluster_of(const Sample& sample);
  std::optional<Sample> first_complex(Sample& low, Sample high);
  std::optional<CriticalPoint> locate(Sample low, Sample high);

  Teuchos::RCP<BeamProblem> problem_;
  ModesParameters asked_;
  bool damped_;
  SolveRecord record_{};
  Corrector corrector_;
  std::optional<Sample> before_{};  ///< previous state, without frequencies if it is held
};

}  // namespace mixbeam
