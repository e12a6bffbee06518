/// Distributed loads and eigenstrains of a scene as one rank applies them to its elements, at any load factor.
#pragma once

#include "discretization/mesh/structure.hpp"
#include "discretization/scene/amplitude.hpp"

#include <vector>

namespace mixbeam {

/// Sizes at a load factor, of the loads on this rank.
struct LineFieldMagnitude {
  double force = 0.0;      ///< largest component of a load per length times the length of its member
  double couple = 0.0;     ///< likewise
  double strain = 0.0;     ///< largest eigenstrain
  double curvature = 0.0;  ///< largest eigencurvature
  double turn = 0.0;       ///< the same times the length of its member: a rotation
};

/// Formulas are evaluated once, at construction; a change of the load factor scales and adds the values.
class LineFields {
 public:
  LineFields() = default;
  /// Gives the blocks of `structure` their rows of values, where the scene has any. Throws InputError for a member that
  /// does not exist, std::invalid_argument for a formula that is none or is not finite somewhere on its member.
  LineFields(const Scene& scene, const Mesh& mesh, Structure& structure);

  /// Whether the scene has distributed loads, on any rank.
  bool has_loads() const { return has_loads_; }
  bool empty() const { return !has_loads_ && !has_eigenstrains_; }

  /// Amplitudes of the fields at a load factor; `with_loads` false: zero but for eigenstrains.
  std::vector<double> amplitudes(double load_factor, bool with_loads = true) const;
  /// Their derivatives with respect to the load factor.
  std::vector<double> slopes(double load_factor) const;
  /// Rows of StructureViews::field_value.
  int rows() const { return rows_; }
  /// Writes the sum of the fields, each times its factor, into these rows.
  void add_up(const Structure& structure, const std::vector<double>& factors, const KernelView<double* [3]>& sum) const;
  LineFieldMagnitude magnitude(double load_factor) const;
  /// Whether all leave elements in a plane with this normal, g2 or g3 of theirs along it. `tolerance`: relative, of
  /// what leaves it.
  bool keep_in_plane(const Structure& structure, const Vec& normal, double tolerance) const;
  /// Whether all are dead forces and eigenstrains.
  bool have_planar_equations() const;
  /// Lets amplitudes run as the clock does from here on.
  void follow(const std::shared_ptr<const LoadClock>& clock) {
    for (Field& field : fields_) field.amplitude.follow(clock);
  }

 private:
  /// One vector along the elements of one member on this rank.
  struct Field {
    LineField kind;
    int member = 0, block = 0;
    Amplitude amplitude{};
    double largest = 0.0;              ///< component, at amplitude 1
    double length = 0.0;               ///< of the member
    int points = 0;                    ///< of each element
    int apart = 0;                     ///< rows of one element and the next; zero: all have the same
    KernelView<int*> elements{};       ///< of the block
    KernelView<double* [3]> value {};  ///< (element by element, point)
  };
  class Profile;
  struct Source;
  void add_source(const Mesh& mesh, Structure& structure, const Source& source);
  void number_rows(Structure& structure);

  std::vector<Field> fields_{};
  int rows_ = 0;
  bool has_loads_ = false, has_eigenstrains_ = false;
};

}  // namespace mixbeam
