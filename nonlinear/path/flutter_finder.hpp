/// Finds the load factors at which natural frequencies meet and become complex, or part again, under loads without a
/// potential and in frames that turn: theory (74).
#pragma once

#include "nonlinear/path/corrector.hpp"
#include "nonlinear/stability/stability.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace mixbeam {

/// Whether some load turns with the structure, or is a moment, or a frame turns: then frequencies may be complex.
bool may_flutter(const Scene& scene);

/// Looks at each state of a path in turn, and half-way between two. Only frequencies among those that the analysis asks
/// for, and a few more, are seen.
class FlutterFinder {
 public:
  FlutterFinder(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters);

  /// The points since the state before at which more frequencies became complex, or fewer. Between them states are
  /// those of Newton's method from one beside. `held`: the state is a minimum of a potential, about which no motion
  /// grows; between two such states nothing is looked for. Without a result where no masses are, or frequencies cannot
  /// be computed. Collective.
  std::vector<CriticalPoint> passed(const State& state, double load_factor, bool held);

 private:
  /// Squares of frequencies about a state, in the order of vibration_modes(), or exponents of damped motions.
  struct Sample {
    State state;
    double load_factor = 0.0;
    std::vector<std::complex<double>> squared{}, rates{};
    std::vector<MixedVector> modes{};

    int complex_values() const;
    int growing() const;            ///< motions
    double largest_growth() const;  ///< rate, over that whose rounding would be one
    size_t most_growing() const;    ///< of the largest rate
    double largest_rate() const { return rates.empty() ? 0.0 : rates[most_growing()].real(); }
  };
  /// Those that meet: neighbours among the frequencies.
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
  std::optional<Sample> before_{};  ///< without frequencies where it is held
};

}  // namespace mixbeam
