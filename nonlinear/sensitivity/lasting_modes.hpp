/// Frequencies of structures beside the one whose modes are known, to first order: modes stay as they are, theory (83).
#pragma once

#include "nonlinear/stability/vibration.hpp"
#include "nonlinear/stability/vibration_operator.hpp"

#include <map>

namespace mixbeam {

/// One process only.
class LastingModes {
 public:
  /// The problem must outlive it.
  LastingModes(BeamProblem& problem, const State& state, double load_factor, const ModesParameters& asked);

  /// omega / (2 pi) of a mode, from 1. Throws std::invalid_argument for one that has no derivative, and says why.
  double frequency(int mode);
  /// Number of modes that share that frequency.
  int together(int mode) { return shared(mode).count; }
  /// (mode, mode) of those: what the frequency changes by in a state beside, of a model that may be another one.
  std::vector<double> changes(int mode, const Model& model, const State& state);

 private:
  struct Shared {
    double square = 0.0;  ///< omega^2
    int count = 0;
    std::vector<VibrationOperator::Response> motions{};  ///< of unit mass, then the sums of two
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
