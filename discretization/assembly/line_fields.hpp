/// Distributed loads and eigenstrains of a scene on the elements of one rank, at any load factor.
#pragma once

#include "discretization/mesh/structure.hpp"
#include "discretization/scene/amplitude.hpp"

#include <vector>

namespace mixbeam {

/// Magnitudes of the loads on this rank at a load factor.
struct LineFieldMagnitude {
  double force = 0.0;      ///< largest component of a load per length times the length of its member
  double couple = 0.0;     ///< same for couples
  double strain = 0.0;     ///< largest eigenstrain
  double curvature = 0.0;  ///< largest eigencurvature
  double turn = 0.0;       ///< eigencurvature times the length of its member: a rotation
};

/// Factor of the profile of a load at arc length s inside its range; `law`: of the member, null if it has one section.
double local_factor(const DistributedLoad& load, const MeshMember& member, const SectionLaw* law, double s);

/// Sum of fields times amplitudes. Formulas are evaluated once, at construction; the load factor scales the values.
class LineFields {
 public:
  LineFields() = default;
  /// Assigns rows of values to the blocks of `structure` if the scene has fields. Throws InputError for a member that
  /// does not exist, std::invalid_argument for an invalid formula or one that is not finite somewhere on its member.
  LineFields(const Scene& scene, const Mesh& mesh, Structure& structure);

  /// True if the scene has distributed loads, on any rank.
  bool has_loads() const { return has_loads_; }
  bool empty() const { return !has_loads_ && !has_eigenstrains_; }

  /// Amplitudes of the fields at a load factor; `with_loads` false: zero except for eigenstrains.
  std::vector<double> amplitudes(double load_factor, bool with_loads = true) const;
  /// Their derivatives with respect to the load factor.
  std::vector<double> slopes(double load_factor) const;
  /// Number of rows of StructureViews::field_value.
  int rows() const { return rows_; }
  /// Writes the sum of the fields, each times its factor, into these rows.
  void add_up(const Structure& structure, const std::vector<double>& factors, const KernelView<double* [3]>& sum) const;
  LineFieldMagnitude magnitude(double load_factor) const;
  /// True if all fields keep elements in a plane with this normal, g2 or g3 along it. `tolerance`: of out-of-plane
  /// parts, relative.
  bool keep_in_plane(const Structure& structure, const Vec& normal, double tolerance) const;
  /// True if all are dead forces and eigenstrains.
  bool have_planar_equations() const;
  /// Makes amplitudes follow the clock from now on.
  void follow(const std::shared_ptr<const LoadClock>& clock) {
    for (Field& field : fields_) field.amplitude.follow(clock);
  }

 private:
  /// Vector field along the elements of one member on this rank.
  struct Field {
    LineField kind;
    int member = 0, block = 0;
    Amplitude amplitude{};
    double largest = 0.0;              ///< largest component at amplitude 1
    double length = 0.0;               ///< of the member
    int points = 0;                    ///< of each element
    int apart = 0;                     ///< offset between the rows of consecutive elements; zero: all have the same
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
