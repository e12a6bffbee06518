/// Solves scene files in a C++ program that finds this library by find_package(mixbeam). Needs only the standard
/// library and no compiler flags: the loader chooses the library for the processor's instruction set.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>

namespace mixbeam {

class SolvedRun;

/// A solved scene. Call it from one thread at a time; it may use several OpenMP threads.
class SolvedScene {
 public:
  /// Reads a scene in XML or YAML and solves it, or the given load case. `results`: a result file to write; empty:
  /// none. Throws std::runtime_error with the message of `mixbeam run` if it cannot be read or does not converge.
  explicit SolvedScene(const std::string& scene, const std::string& results = "", const std::string& load_case = "");
  SolvedScene(SolvedScene&&) noexcept;
  ~SolvedScene();

  /// Load factor at the end of the path, to which displacement() and rotation() belong too.
  double load_factor() const;
  std::array<double, 3> displacement(const std::string& point) const;
  /// Rotation vector, norm at most pi.
  std::array<double, 3> rotation(const std::string& point) const;
  /// Values of the list `Quantities` of the scene at the end: "tip", "tip.x", ...
  std::map<std::string, double> quantities() const;
  /// Output of `mixbeam run`.
  std::string report() const;

 private:
  std::unique_ptr<SolvedRun> run_;
};

}  // namespace mixbeam
