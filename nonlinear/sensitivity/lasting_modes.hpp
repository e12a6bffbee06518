/// Frequencies of structures close to one whose modes are known, to first order, with fixed modes, theory (83).
#pragma once

#include "nonlinear/stability/vibration.hpp"
#include "nonlinear/stability/vibration_operator.hpp"

#include <map>

namespace mixbeam {

/// Modes that are kept while the structure changes. One process only.
class LastingModes {
 public:
  /// The problem must outlive it.
  LastingModes(BeamProblem& problem, const State& state, double load_factor, const ModesParameters& asked);

  /// Frequency omega / (2 pi) of a mode, from 1. Throws std::invalid_argument with the reason if it has no derivative.
  double frequency(int mode);
  /// Number of modes that share that frequency.
  int together(int mode) { return shared(mode).count; }
  /// Returns (mode, mode) of those: change of the frequency in a neighbouring state, possibly of another model.
  std::vector<double> changes(int mode, const Model& model, const State& state);

 private:
  struct Shared {
    double square = 0.0;  ///< omega^2
    int count = 0;
    std::vector<VibrationOperator::Response> motions{};  ///< of unit modal mass, then the sums of pairs
  };
  const Shared& shared(int mode);
  Shared of_cluster(int first, int count);
  void orthonormalize(std::vector<VibrationOperator::Response>& motions) const;

  ModesParameters asked_;
  double load_factor_;
  VibrationOperator operator_;
  std::vector<VibrationMode> modes_{};
  std::map<int, Shared> shared_{};  ///< by the first mode
};

}  // namespace mixbeam
