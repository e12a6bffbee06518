/// Solves scene files in a program in C++ that finds this library by find_package(mixbeam). Needs the standard library
/// alone, and no compiler flags: the loader chooses the library for the instruction set of the processor.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>

namespace mixbeam {

class SolvedRun;

/// A scene, solved. For one thread at a time, which may take several threads of OpenMP for it.
class SolvedScene {
 public:
  /// Reads a scene in XML or YAML and solves it, or the load case that is named. `results`: a result file to write,
  /// none where empty. Throws std::runtime_error with the text that `mixbeam run` prints where it cannot be read or
  /// does not converge.
  explicit SolvedScene(const std::string& scene, const std::string& results = "", const std::string& load_case = "");
  SolvedScene(SolvedScene&&) noexcept;
  ~SolvedScene();

  /// Of the state at the end of the path.
  double load_factor() const;
  std::array<double, 3> displacement(const std::string& point) const;
  /// Rotation vector, norm at most pi.
  std::array<double, 3> rotation(const std::string& point) const;
  /// Numbers that the list `Quantities` of the scene asks for: "tip", "tip.x", ...
  std::map<std::string, double> quantities() const;
  /// Pages that `mixbeam run` would print.
  std::string report() const;

 private:
  std::unique_ptr<SolvedRun> run_;
};

}  // namespace mixbeam
