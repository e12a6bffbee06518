/// Sections of blades from programs that compute or exchange their stiffness and mass matrices.
#pragma once

#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Formats of the programs whose files are read: VABS (NAME.K), BECAS (its report NAME.out), BeamDyn (blade input file,
/// which SONATA writes for ANBA4 and VABS), WindIO (blade of a turbine in YAML, versions 1 and 2), HAWC2 (st file), and
/// ANBA4 (arrays as NumPy prints or saves them as text).
enum class BladeFormat { none, vabs, becas, beamdyn, windio, hawc2, anba };

/// One section along a blade.
struct BladeStation {
  double position = 0.0;  ///< along the reference axis, from 0 to 1
  Matrix6 stiffness{};    ///< of (gamma_1, gamma_2, gamma_3, kappa_1, kappa_2, kappa_3) about the reference axis
  Matrix6 mass{};         ///< of (velocity, spin) in the same order, kinetic energy 1/2 v . M v; zero: not in the file
  double twist = 0.0;     ///< of axes 2 and 3 about axis 1 [radian]
  Vector3 place{};  ///< of the reference axis along the axes (2, 3, 1) of a section without twist; WindIO and HAWC2
};

/// Determines the format of a text by words that each format writes.
BladeFormat blade_format(const std::string& text);

/// Reads the sections of a text; `file` appears in messages. Throws InputError for violations of the format, and for
/// matrices that no section has (not symmetric, impossible moments of inertia).
std::vector<BladeStation> read_blade(const std::string& text, const std::string& file);

/// Entries of the list "Sections" from a text: `Matrix`, and if it has them `Mass`, `Mass Offset`, `Rotary Inertia`,
/// `Inertia Product`. One section is named after the file without its ending, several "station 1", ...
Teuchos::ParameterList sections_of_blade(const std::string& text, const std::string& file);

/// A scene of one blade, clamped at its root, from files in order from root to tip: sections_of_blade(), and a member
/// with `Section Stations`. Files without a reference axis give a straight blade of length `L`, a variable that is 1,
/// with equally spaced sections if each file has one; `remarks` gets a sentence for each such assumption.
Teuchos::ParameterList scene_of_blades(const std::vector<std::string>& files, std::vector<std::string>& remarks);

}  // namespace mixbeam
